"""The experiment that best tells the rivals of a cause apart, each refitted.

T-optimal design (Atkinson and Fedorov 1975): of the excitations u within the limits, take the one that maximises
min over theta of |y_A(u, theta_A) - y_B(u, theta)|^2 over the floor, for the rival B that comes closest. The simulator makes the data of A;
the diagnosis itself fits every B to them and scores them on held-out repeats, so what is maximised is what will decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot, Sher3Error
from sher3_sim import Effect

from sher3_gap.attribute import PRICE, RIVAL, Candidates
from sher3_gap.channels import Channel
from sher3_gap.design import Design, build
from sher3_gap.evidence import Evidence, gather
from sher3_gap.excitation import Excitation, catalogue, excite
from sher3_gap.fitting import Fit, fit
from sher3_gap.library import LIBRARY
from sher3_gap.loading import signals_of
from sher3_gap.rehearsal import rehearse
from sher3_gap.simulator import to_effects
from sher3_gap.verdict import Cause, Verdict

REPEATS = 2
"""Repeats a design is scored on: each with coefficients fitted to the other."""
ROUNDS = 2
"""Passes of the coordinate search over the design's parameters."""


class ExperimentError(Sher3Error):
    """No experiment can be designed from this verdict."""


@dataclass(frozen=True)
class Separation:
    """How far an excitation separates the cause from its closest rival, both refitted.

    Attributes:
        floors: rms difference of the two refitted models in units of the floor.
        margin: the difference in held-out loss over what the diagnosis asks for; above 1 the rival is ruled out.
        closest: the rival that remains closest.
    """

    floors: float
    margin: float
    closest: str


@dataclass(frozen=True)
class Experiment:
    """The excitation to run, what it separates and how far it is predicted to."""

    excitation: Excitation
    design: dict[str, float | str]
    separates: tuple[str, ...]
    predicted: Separation
    tried: int


def rivals_of(verdict: Verdict) -> tuple[Cause, tuple[str, ...]]:
    """Return the cause with rivals, and their ids.

    Raises:
        ExperimentError: nothing is left to tell apart.
    """
    cause = next((c for c in verdict.causes if c.rivals), None)
    if cause is None:
        raise ExperimentError(f"the verdict {verdict.status!r} leaves no rivals to tell apart", remedy="nothing to do")
    exact = [r for r in cause.rivals if not LIBRARY[r].channels(LIBRARY[r].sites()[0])]
    return cause, tuple(r for r in cause.rivals if r not in exact)


def design_experiment(verdict: Verdict, robot: Robot, say: Callable[[str], None] = lambda _: None) -> Experiment:
    """Choose the excitation that separates the first cause with rivals from the closest of them.

    Raises:
        ExperimentError: the verdict has no rivals.
    """
    cause, rivals = rivals_of(verdict)
    truth = to_effects([cause], robot)
    others = [c for c in verdict.causes if c is not cause and not LIBRARY[c.effect].stage == "transport"]
    truth += [e for e in to_effects(others, robot) if (e.id, e.actuator) not in {(t.id, t.actuator) for t in truth}]
    judge = _Judge(robot, cause, rivals, truth)
    site = cause.actuator if cause.actuator in ACTUATORS else "all"
    best: tuple[Separation, Excitation, dict[str, float | str]] | None = None
    for made, about in _candidates(robot, site, lambda: best):
        found = judge.separation(made)
        say(f"{made.label} {about.get('posture', '')}: {found.floors:.2f} floors")
        if best is None or found.margin > best[0].margin:
            best = (found, made, about)
    assert best is not None
    separates = (cause.effect, *rivals)
    return Experiment(best[1], best[2], separates, best[0], judge.count)


def _candidates(
    robot: Robot, site: str, best: Callable[[], tuple | None]
) -> Iterable[tuple[Excitation, dict[str, float | str]]]:
    """Yield the standard set, then the neighbours of the best design so far, parameter by parameter."""
    for name in catalogue():
        if name != "task":
            yield excite(name, robot, duration=6.0), {"standard": name, "posture": "p0"}
    seen = {Design(actuator=site)}
    yield build(Design(actuator=site), robot), Design(actuator=site).as_dict()
    for _ in range(ROUNDS):
        kept = best()
        centre = Design(**kept[2]) if kept and "standard" not in kept[2] else Design(actuator=site)
        fresh = [d for d in centre.neighbours() if d not in seen]
        for design in fresh:
            seen.add(design)
            yield build(design, robot), design.as_dict()


class _Judge:
    """Simulates the cause on an excitation and fits cause and rivals to the result."""

    def __init__(self, robot: Robot, cause: Cause, rivals: Sequence[str], truth: Sequence[Effect]) -> None:
        self.robot, self.cause, self.rivals, self.truth = robot, cause, rivals, truth
        self.count = 0

    def separation(self, excitation: Excitation) -> Separation:
        """Return how far an excitation separates the cause from its closest rival."""
        self.count += 1
        runs = rehearse(self.robot, [(excitation, r) for r in range(REPEATS)], self.truth, seed=self.count)
        evidence = gather([signals_of(run, self.robot, f"repeat {i}") for i, run in enumerate(runs)], self.robot)
        candidates = Candidates(evidence)
        own = candidates.best(LIBRARY[self.cause.effect], self.cause.actuator)
        if own is None:
            return Separation(0.0, 0.0, self.rivals[0])
        losses = {rival: self._loss(candidates, rival, own) for rival in self.rivals}
        closest = min(losses, key=losses.__getitem__)
        behind = losses[closest] - own.total
        worth = fit(evidence.data, []).total - own.total
        samples = _samples(evidence, own.terms[-1].channels)
        floors = float(np.sqrt(max(behind, 0.0) / max(samples, 1)))
        return Separation(floors, behind / max(3.0 * PRICE, RIVAL * worth), closest)

    def _loss(self, candidates: Candidates, rival: str, own: Fit) -> float:
        """Return the least held-out loss of a rival, at any site where it shows in the cause's channels."""
        effect = LIBRARY[rival]
        channels = own.terms[-1].channels
        sites = [s for s in effect.sites() if set(effect.channels(s)) & set(channels)]
        fits = [f for s in sites if (f := candidates.best(effect, s)) is not None]
        return min((f.total for f in fits), default=float("inf"))


def _samples(evidence: Evidence, channels: Iterable[Channel]) -> int:
    return sum(n for (_, c), n in evidence.data.samples.items() if c in set(channels))
