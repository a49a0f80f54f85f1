"""What the causes of one joint may be together."""

from __future__ import annotations

from sher3_diagnosis.attribute.candidates import possible
from sher3_diagnosis.fit.fitting import Fit


def possible_at_one_joint(trial: Fit) -> bool:
    """Return whether the new cause is possible, and all others beside it still are.

    Of what hides behind one encoder one cause is named: a load that rings looks like one that is thrown across a gap.
    One law of dry friction holds an axis: two of them side by side have the loop of a play.
    """
    unseen = sum(t.effect.unseen for t in trial.terms)
    dry = sum(t.effect.dry for t in trial.terms)
    return unseen <= 1 and dry <= 1 and possible(trial) and trial.admissible
