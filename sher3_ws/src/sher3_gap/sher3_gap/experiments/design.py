"""The experiment that best tells the rivals of a cause apart, each refitted.

T-optimal design (Atkinson and Fedorov 1975): of the excitations u within the limits, take the one that maximises
min over theta of |y_A(u, theta_A) - y_B(u, theta)|^2 over the floor, for the rival B that comes closest. The simulator
makes the data of A; the diagnosis itself fits every B to them and scores them on held-out repeats, so what is maximised
is what will decide. The best few are judged again over draws of A's parameters, noise and scatter, and the mean counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from sher3_common import Sher3Error
from sher3_common.progress import Say, silent
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.verdict import Cause, Parameter, Verdict
from sher3_effects import library, to_effects
from sher3_sim import PlantEffect

from sher3_gap.case.loading import signals_of
from sher3_gap.evidence import gather
from sher3_gap.excitation import Excitation, catalogue, excite
from sher3_gap.experiments.family import CHOICES, Choices, Design, build
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.experiments.separation import Prediction, Separation, floors_of, separation
from sher3_gap.signals import RunSignals
from sher3_gap.stages.floors import Floors
from sher3_gap.stages.units import PLACES

REPEATS = 2
"""Repeats a design is scored on: each with coefficients fitted to the other."""
DRAWS = 4
"""Draws of parameters, noise and scatter a prediction is the mean of."""
FINALISTS = 3
"""Excitations that are judged over all the draws."""


class ExperimentError(Sher3Error):
    """No experiment can be designed from this verdict."""


@dataclass(frozen=True)
class Given:
    """What the case behind the verdict says of the next one.

    Attributes:
        floor: per channel, which a prediction does not undercut.
        present: excitations that have left the rivals standing.
        loads: whether known loads can be put on its tip: it has some.
    """

    floor: Floors
    present: frozenset[str] = frozenset()
    loads: bool = True

    @classmethod
    def of(cls, runs: Sequence[RunSignals], robot: Robot) -> Given:
        """Read it off the runs of a case."""
        return cls(
            floors_of(gather(runs, robot)),
            frozenset(run.excitation for run in runs),
            any(run.payload for run in runs),
        )


@dataclass(frozen=True)
class Experiment:
    """The excitation to run, what it separates and how far it is predicted to."""

    excitation: Excitation
    design: dict[str, float | str]
    separates: tuple[str, ...]
    predicted: Prediction
    tried: int


def rivals_of(verdict: Verdict) -> tuple[Cause, tuple[str, ...]]:
    """Return the cause with rivals, and their ids.

    Raises:
        ExperimentError: nothing is left to tell apart.
    """
    cause = next((c for c in verdict.causes if c.rivals), None)
    if cause is None:
        raise ExperimentError(f"the verdict {verdict.status!r} leaves no rivals to tell apart", remedy="nothing to do")
    exact = [r for r in cause.rivals if not library()[r].channels(PLACES[library()[r].places[0]][0])]
    return cause, tuple(r for r in cause.rivals if r not in exact)


def design_experiment(
    verdict: Verdict,
    robot: Robot,
    say: Say = silent,
    choices: Choices = CHOICES,
    runs: Sequence[RunSignals] = (),
) -> Experiment:
    """Choose the excitation that separates the first cause with rivals from the closest of them.

    Args:
        verdict: with rivals.
        robot: whose limits are kept.
        say: progress.
        choices: values of each parameter of the family that are tried.
        runs: of the case behind the verdict: its floors count, its excitations are not proposed again, and loads only
            where it has some.

    Raises:
        ExperimentError: the verdict has no rivals.
    """
    cause, rivals = rivals_of(verdict)
    given = Given.of(runs, robot) if runs else Given({})
    if not given.loads:
        choices = {**choices, "load": ()}
    search = _Search(_Judge(robot, verdict, cause, rivals, given.floor), robot, say)
    search.standard(given)
    search.family(Design(actuator=cause.actuator if cause.actuator in ACTUATORS else "all"), choices)
    predicted, excitation, about = search.winner()
    return Experiment(excitation, about, (cause.effect, *rivals), predicted, search.judge.count)


def realised(verdict: Verdict, robot: Robot, runs: Sequence[RunSignals]) -> Separation:
    """Return how far recorded runs of an experiment separate the verdict's cause from its rivals.

    Raises:
        ExperimentError: the verdict has no rivals, or there are fewer than two runs.
    """
    if len(runs) < REPEATS:
        raise ExperimentError("too few runs to judge", value=len(runs), limit=REPEATS, remedy="record repeats")
    cause, rivals = rivals_of(verdict)
    return separation(runs, robot, (cause.effect, cause.actuator), rivals)


About = dict[str, float | str]


@dataclass
class _Search:
    """Tries excitations and keeps the best."""

    judge: _Judge
    robot: Robot
    say: Say

    def __post_init__(self) -> None:
        self.tried: list[tuple[Separation, Excitation, About]] = []

    def standard(self, given: Given) -> None:
        """Try the standard set, less what has been run and what cannot be."""
        for name in catalogue():
            if name != "task" and name not in given.present and (given.loads or name != "loads"):
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

    def winner(self) -> tuple[Prediction, Excitation, About]:
        """Judge the best few over all draws and return the one with the largest mean margin."""
        first = sorted(self.tried, key=lambda t: -t[0].margin)[:FINALISTS]
        judged = [(self.judge.prediction(excitation), excitation, about) for _, excitation, about in first]
        return max(judged, key=lambda j: j[0].margin)

    def _try(self, excitation: Excitation, about: About) -> float:
        found = self.judge.separation(excitation)
        self.say(f"{excitation.label}: {found.floors:.2f} floors from {found.closest}")
        self.tried.append((found, excitation, about))
        return found.margin


class _Judge:
    """Simulates the cause on an excitation and fits cause and rivals to the result."""

    def __init__(self, robot: Robot, verdict: Verdict, cause: Cause, rivals: Sequence[str], floor: Floors) -> None:
        self.robot, self.verdict, self.cause, self.rivals, self.floor = robot, verdict, cause, rivals, floor
        self.count = 0

    def prediction(self, excitation: Excitation) -> Prediction:
        """Return the separation over draws of the cause's parameters, noise and scatter."""
        return Prediction(tuple(self.separation(excitation, draw) for draw in range(DRAWS)))

    def separation(self, excitation: Excitation, draw: int = 0) -> Separation:
        """Return how far an excitation separates the cause from its closest rival; draw 0 takes the fitted values."""
        self.count += 1
        truth = self._effects(draw)
        made = rehearse(self.robot, [(excitation, r) for r in range(REPEATS)], truth, seed=100 * draw + self.count)
        runs = [signals_of(run, self.robot, f"repeat {i}") for i, run in enumerate(made)]
        return separation(runs, self.robot, (self.cause.effect, self.cause.actuator), self.rivals, self.floor)

    def _effects(self, draw: int) -> list[PlantEffect]:
        """Return the causes as effects, the one in question with parameters drawn from their intervals."""
        rng = np.random.default_rng((71, draw))
        parameters = {n: _drawn(p, rng) if draw else p for n, p in self.cause.parameters.items()}
        cause = self.cause.model_copy(update={"parameters": parameters})
        truth = to_effects([cause], self.robot)
        others = [c for c in self.verdict.causes if c is not self.cause and library()[c.effect].stage != "transport"]
        known = {(t.id, t.actuator) for t in truth}
        return truth + [e for e in to_effects(others, self.robot) if (e.id, e.actuator) not in known]


def _drawn(parameter: Parameter, rng: np.random.Generator) -> Parameter:
    """Return a parameter drawn from its interval; whole numbers are names of a variant and stay."""
    if parameter.low is None or parameter.high is None or (parameter.unit == "1" and parameter.value.is_integer()):
        return parameter
    sigma = (parameter.high - parameter.low) / 4.0
    return parameter.model_copy(
        update={"value": float(np.clip(rng.normal(parameter.value, sigma), parameter.low, parameter.high))}
    )
