"""What a wrong answer costs: the one place where odds turn into an answer."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, fields

from sher3_common.errors import Sher3Error

from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE

ANSWERS = (OUTSIDE, LIBRARY, NO_GAP)
"""In this order where two cost the same."""


class CostsError(Sher3Error):
    """Costs that are none: no such mistake, or no positive number."""


@dataclass(frozen=True)
class Costs:
    """What each mistake costs, in any unit: only their ratios count.

    By default all cost the same, so that the most probable answer is given. A verdict lists the odds of every answer,
    and the best explanation also where the answer is another: neither a name nor an abstention hides the other, so
    that nothing general makes one of them worse. Whoever builds on a verdict without reading its odds says so:
    `name=3` abstains below odds of three to one.

    Attributes:
        name: an effect is named and is not the cause.
        abstain: the library is said to lack a cause that it has, or a gap that is none.
        miss: a gap is said to be none.
    """

    name: float = 1.0
    abstain: float = 1.0
    miss: float = 1.0

    @classmethod
    def parse(cls, text: str) -> Costs:
        """Read `name=3,abstain=1`; what is not named costs 1. Raises CostsError."""
        known = {f.name for f in fields(cls)}
        given: dict[str, float] = {}
        for pair in filter(None, text.split(",")):
            mistake, _, number = pair.partition("=")
            try:
                cost = float(number)
            except ValueError:
                cost = math.nan
            if mistake not in known or not 0.0 < cost < math.inf:
                limit = f"MISTAKE=COST above 0, of {', '.join(sorted(known))}"
                raise CostsError("no such cost", value=pair, limit=limit, remedy="as in name=3,abstain=1")
            given[mistake] = cost
        return cls(**given)

    def as_dict(self) -> dict[str, float]:
        """Return mistake -> cost."""
        return asdict(self)

    def cheapest(self, odds: Mapping[str, float], among: Collection[str] = ANSWERS) -> str:
        """Return the answer that costs least on average.

        Args:
            odds: answer -> probability; what is missing has none.
            among: the answers that may be given.
        """
        cost = {LIBRARY: self.name, OUTSIDE: self.abstain, NO_GAP: self.miss}
        return min((a for a in ANSWERS if a in among), key=lambda a: cost[a] * (1.0 - odds.get(a, 0.0)))


DEFAULT = Costs()
"""What holds where nobody says otherwise."""
