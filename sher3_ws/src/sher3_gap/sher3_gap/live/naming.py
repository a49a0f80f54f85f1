"""Which effect it is: the seconds since a gap showed, cut into pieces and diagnosed like the runs of a case."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.report.summary import headline
from sher3_diagnosis.verdict import Verdict

from sher3_gap.errors import CaseError
from sher3_gap.sher import diagnose_runs
from sher3_gap.signals import RunSignals

PIECES = 5
"""Pieces a stretch is cut into: each is left out of a fit once."""
LEAST = 5.0
"""Seconds with a gap that are needed: a piece shorter than one second holds too few reversals."""
AGAIN = 2.0
"""Seconds after which the stretch, longer by then, is asked again while nothing is named."""
SETTLED = 2
"""Seconds in a row that must show a gap before a name is looked for: one that comes and goes is noise."""


class Named(NamedTuple):
    """What the gap of a running robot is.

    Attributes:
        stamp: when it was named, ns.
        verdict: on the stretch since the gap showed.
    """

    stamp: int
    verdict: Verdict

    @property
    def text(self) -> str:
        """The finding in a sentence."""
        return headline(self.verdict)

    @property
    def probability(self) -> float | None:
        """Probability of the first cause; None where the verdict states none."""
        causes = self.verdict.causes
        return getattr(causes[0], "probability", None) if causes else None


@dataclass
class Naming:
    """Watches whether a gap stays, and names it; `look` once a second.

    Args:
        robot: the nominal model.
        stretch: returns the signals of so many newest seconds; None where they are not whole.
        executor: that names beside the caller, who must go on listening; None names at once.
    """

    robot: Robot
    stretch: Callable[[float], RunSignals | None]
    since: int | None = None
    seen: int = 0
    asked: int = 0
    named: Named | None = None
    executor: Executor | None = None
    pending: Future[Named | None] | None = None

    def look(self, stamp: int, gap: bool) -> Named | None:
        """Return the causes named now, or None; a name stays until the gap is gone.

        Args:
            stamp: now, ns.
            gap: whether any stage is above its floor.
        """
        if not gap:
            self.since, self.seen, self.named, self.pending = None, 0, None, None
            return None
        if self.pending is not None:
            if not self.pending.done():
                return None
            self.named, self.pending = self.pending.result(), None
        self.since = stamp if self.since is None else self.since
        self.seen += 1
        seconds = (stamp - self.since) * 1e-9
        if self.named is None and self.seen >= SETTLED and seconds >= LEAST and stamp - self.asked >= AGAIN * 1e9:
            self._ask(stamp, seconds)
        return self.named

    def _ask(self, stamp: int, seconds: float) -> None:
        """Name the newest seconds, now or beside the caller."""
        self.asked = stamp
        run = self.stretch(seconds)
        if run is None:
            return
        if self.executor is None:
            self.named = self._name(stamp, run)
        else:
            self.pending = self.executor.submit(self._name, stamp, run)

    def _name(self, stamp: int, run: RunSignals) -> Named | None:
        try:
            verdict = diagnose_runs(pieces(run), self.robot).verdict
        except CaseError:
            return None
        return Named(stamp, verdict) if verdict.status != "no_gap" else None


def pieces(run: RunSignals) -> list[RunSignals]:
    """Return a run cut into parts of equal length, each under its own name, so that none counts as a repeat."""
    edges = np.linspace(0, run.ticks, PIECES + 1).astype(int)
    return [_piece(run, k, a, b) for k, (a, b) in enumerate(pairwise(edges))]


def _piece(run: RunSignals, number: int, first: int, last: int) -> RunSignals:
    along = {f.name: getattr(run, f.name) for f in fields(run)}
    cut: dict[str, Any] = {
        n: x[first:last] for n, x in along.items() if isinstance(x, np.ndarray) and len(x) == run.ticks
    }
    cut["stage_clock"] = cut["stage_clock"] - cut["stage_clock"][0]
    return replace(run, name=f"piece {number + 1}", excitation=f"piece_{number + 1}", **cut)
