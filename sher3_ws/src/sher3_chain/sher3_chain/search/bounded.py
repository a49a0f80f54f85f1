"""Candidates of which no new cause makes another one impossible."""

from __future__ import annotations

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.fit.fitting import Fit


class Bounded(Candidates):
    """Candidates of which a new cause may not push another one beyond what is physically possible.

    Of what hides behind one encoder one cause is named: a load that rings looks like one that is thrown across a gap.
    One law of dry friction holds an axis: two of them side by side have the loop of a play.
    """

    def possible(self, trial: Fit) -> bool:
        """Return whether the new cause is possible, and all others still are."""
        unseen = sum(t.effect.unseen for t in trial.terms)
        dry = sum(t.effect.dry for t in trial.terms)
        return unseen <= 1 and dry <= 1 and super().possible(trial) and trial.admissible
