"""The experiment that best tells the rivals of a cause apart, each refitted.

T-optimal design (Atkinson and Fedorov 1975): of the excitations u within the limits, take the one that maximises
min over theta of |y_A(u, theta_A) - y_B(u, theta)|^2 over the floor, for the rival B that comes closest. The simulator
makes the data of A; the diagnosis itself fits every B to them and scores them on held-out repeats, so what is maximised
is what will decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from sher3_description import ACTUATORS, Robot, Sher3Error
from sher3_sim import Effect

from sher3_gap.attribute import PRICE, RIVAL, Candidates
from sher3_gap.channels import Channel
from sher3_gap.design import CHOICES, Choices, Design, build
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


def design_experiment(
    verdict: Verdict, robot: Robot, say: Callable[[str], None] = lambda _: None, choices: Choices = CHOICES
) -> Experiment:
    """Choose the excitation that separates the first cause with rivals from the closest of them.

    Args:
        verdict: with rivals.
        robot: whose limits are kept.
        say: progress.
        choices: values of each parameter of the family that are tried.

    Raises:
        ExperimentError: the verdict has no rivals.
    """
    cause, rivals = rivals_of(verdict)
    truth = to_effects([cause], robot)
    others = [c for c in verdict.causes if c is not cause and LIBRARY[c.effect].stage != "transport"]
    truth += [e for e in to_effects(others, robot) if (e.id, e.actuator) not in {(t.id, t.actuator) for t in truth}]
    search = _Search(_Judge(robot, cause, rivals, truth), robot, say)
    search.standard()
    search.family(Design(actuator=cause.actuator if cause.actuator in ACTUATORS else "all"), choices)
    assert search.best is not None
    predicted, excitation, about = search.best
    return Experiment(excitation, about, (cause.effect, *rivals), predicted, search.judge.count)


@dataclass
class _Search:
    """Tries excitations and keeps the best."""

    judge: _Judge
    robot: Robot
    say: Callable[[str], None]
    best: tuple[Separation, Excitation, dict[str, float | str]] | None = None

    def standard(self) -> None:
        """Try the standard set."""
        for name in catalogue():
            if name != "task":
                self._try(excite(name, self.robot), {"standard": name})

    def family(self, start: Design, choices: Choices) -> None:
        """Search the family one parameter after the other, each from the best member so far."""
        best, kept = self._try(build(start, self.robot), start.as_dict()), start
        for parameter, values in choices.items():
            centre = kept
            for design in (replace(centre, **{parameter: v}) for v in values if v != getattr(centre, parameter)):
                margin = self._try(build(design, self.robot), design.as_dict())
                if margin > best:
                    best, kept = margin, design

    def _try(self, excitation: Excitation, about: dict[str, float | str]) -> float:
        found = self.judge.separation(excitation)
        self.say(f"{excitation.label}: {found.floors:.2f} floors from {found.closest}")
        if self.best is None or found.margin > self.best[0].margin:
            self.best = (found, excitation, about)
        return found.margin


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
        return Separation(floors, float(behind / max(3.0 * PRICE, RIVAL * worth)), closest)

    def _loss(self, candidates: Candidates, rival: str, own: Fit) -> float:
        """Return the least held-out loss of a rival, at any site where it shows in the cause's channels."""
        effect = LIBRARY[rival]
        channels = own.terms[-1].channels
        sites = [s for s in effect.sites() if set(effect.channels(s)) & set(channels)]
        fits = [f for s in sites if (f := candidates.best(effect, s)) is not None]
        return min((f.total for f in fits), default=float("inf"))


def _samples(evidence: Evidence, channels: Iterable[Channel]) -> int:
    return sum(n for (_, c), n in evidence.data.samples.items() if c in set(channels))
