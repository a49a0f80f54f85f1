"""The plan of a search: what a machine declares of the order and the limits in which its causes are looked for.

Every search adds the cause that explains most of a gap while one is left, drops causes that cost nothing to drop, and
names what would explain as much (`search.py`). A plan says what is different on a machine, and why stands beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from sher3_diagnosis.attribute.candidates import Candidates, Order, as_found, possible
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.thresholds import MAX_CAUSES

Review = Callable[[Any, Attribution], Attribution]
"""Puts an attribution of some evidence right; the evidence is the machine's own."""


def nothing(evidence: Any, found: Fit) -> float:
    """Return no loss beyond that of the residuals."""
    return 0.0


@dataclass(frozen=True)
class Opening:
    """A second search of the same evidence that begins with other causes.

    Attributes:
        order: of the trials of its steps.
        tried: whether it is made at all, given the candidates and the fit that was found without it.
        worth: share of the loss above the floor by which its fit must be smaller to be taken.
        unseen: whether effects behind the only encoder may be named; nothing but an opening names them.
    """

    order: Order
    tried: Callable[[Candidates, Fit], bool]
    worth: float = 0.0
    unseen: bool = False


@dataclass(frozen=True)
class SearchPlan:
    """How the causes of one piece of evidence are looked for.

    Attributes:
        causes: named at most.
        down_to_floor: whether causes are looked for until no gap is left at all. For machines whose description leaves
            several plain causes out; otherwise a known cause may leave a share, since laws are idealisations.
        possible: whether a trial may be an answer; default where its last cause is physically possible.
        order: of the trials of a step; default the cheapest first.
        layers: whether plain effects, then all others, are grown by the price of their numbers: for many small errors
            of which each explains little alone.
        single: improves a cause that is alone before a second one is looked for; for laws that are exact.
        together: whether plain laws are fitted at once and richer ones looked for in what they leave; each cause is
            then searched again beside the others.
        beyond: loss of a fit that is in no residual, in squares of the floor: that of an axis at rest, for example.
        openings: further searches, in turn.
        reviews: put the result right, in turn.
    """

    causes: int = MAX_CAUSES
    down_to_floor: bool = False
    possible: Callable[[Fit], bool] = possible
    order: Order = as_found
    layers: bool = False
    single: Review | None = None
    together: bool = False
    beyond: Callable[[Any, Fit], float] = nothing
    openings: Sequence[Opening] = ()
    reviews: Sequence[Review] = ()
