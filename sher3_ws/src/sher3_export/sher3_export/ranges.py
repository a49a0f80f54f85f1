"""Ranges for randomisation: 90 % interval of each constant, rivals included, and the residual of the causes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from sher3_common import dump_yaml
from sher3_diagnosis.verdict import Cause, Identified, Noise, Parameter, Verdict
from sher3_diagnosis.words import range_text, share, words

from sher3_export.changes import constants_of

SHARE = 0.90
"""Probability of a range."""
LEAST = 5e-4
"""Probability of a cause that a verdict does not list: below it none is listed."""
NARROWER = 1.645 / 1.960
"""Half width of a normal distribution's 90 % interval over that of its 95 % interval, which verdicts give."""


@dataclass(frozen=True)
class Ranges:
    """What a randomised model should cover.

    Attributes:
        worlds: sets of causes that explain the runs, the verdict's first; one of them is at work.
        shares: probability of each world; empty: each is as probable as the others.
        remainder: joint -> force that the causes leave, standard deviation over a quarter of a second, N or N m; empty
            where it was not measured.
        identified: inertias beyond the model's, alike in all worlds.
        noise: of readings, alike in all worlds.
        width: share of the 90 % intervals that the recorded motion needs; 1 where it was not measured.
        motors: motor whose causes these are, by the joint of its name -> joint -> its travel per travel of the joint.
    """

    worlds: Sequence[Sequence[Cause]]
    shares: Sequence[float] = ()
    remainder: Mapping[str, float] = field(default_factory=dict)
    identified: Sequence[Identified] = ()
    noise: Sequence[Noise] = ()
    width: float = 1.0
    motors: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def draw(self, rng: np.random.Generator) -> list[Cause]:
        """Return the causes of one world with parameters drawn from their intervals."""
        world = self.worlds[int(rng.choice(len(self.worlds), p=self.probabilities))]
        return [c.model_copy(update={"parameters": self._drawn(c.parameters, rng)}) for c in world]

    def draw_inertias(self, rng: np.random.Generator) -> list[Identified]:
        """Return the identified inertias, those with an interval drawn from it."""
        return [x.model_copy(update={"constants": self._drawn(x.constants, rng)}) for x in self.identified]

    def _drawn(self, each: Mapping[str, Parameter], rng: np.random.Generator) -> dict[str, Parameter]:
        return {name: drawn(p, rng, self.width) for name, p in each.items()}

    @property
    def probabilities(self) -> list[float]:
        """Probability of each world."""
        known = list(self.shares) or [1.0] * len(self.worlds)
        return [share / sum(known) for share in known]

    def lines(self) -> list[str]:
        """Return a line for each number of each set of causes, with its range; sets parted by their odds."""
        out = []
        for world, odds in zip(self.worlds, self.probabilities, strict=True):
            out += [f"one of {len(self.worlds)} sets, {share(odds)}:"] if len(self.worlds) > 1 else []
            for cause in world:
                for name, found in _ranges(cause.parameters, self.width).items():
                    low, high = found["range"]
                    what = f"{cause.effect} on {cause.actuator}: {words(name).lower()}"
                    out.append(f"{what} {range_text(low, high, found['unit'])}")
        return out

    def text(self) -> str:
        """Return the ranges as YAML, `schema: sher3.ranges/1`."""
        worlds = [[_entry(cause, self.width) for cause in world] for world in self.worlds]
        data = {
            "schema": "sher3.ranges/1",
            "share": SHARE,
            "width": float(self.width),
            "one_of": worlds,
            "probability": [round(p, 4) for p in self.probabilities],
            "remainder": {j: float(s) for j, s in self.remainder.items()},
            "motors": {motor: dict(travel) for motor, travel in self.motors.items()},
            "identified": [{"place": x.actuator, **_ranges(x.constants, self.width)} for x in self.identified],
            "noise": [x.model_dump(exclude_none=True) for x in self.noise],
        }
        whose = "motors: a cause at one of them is the motor's, by its own travel per travel of each joint."
        remarks = (
            "One of these sets of causes is at work, with its probability; values add to the nominal ones.",
            "width: of the verdict's 90 % intervals, as much as the recorded motion needs.",
            "remainder: force that the causes leave, standard deviation, constant for 0.25 s at a time.",
            *([whose] if self.motors else []),
            *(["noise: standard deviation of single readings, to draw for each observation."] if self.noise else []),
        )
        said = {name: x for name, x in data.items() if x or name not in ("motors", "identified", "noise")}
        return "".join(f"# {line}\n" for line in remarks) + dump_yaml(said)


def worlds_of(verdict: Verdict, others: Sequence[Verdict] = ()) -> list[Sequence[Cause]]:
    """Return the sets of causes that may be at work: those of a verdict and of verdicts without one of its causes."""
    return [verdict.causes, *(x.causes for x in others if x.causes)]


def shares_of(verdict: Verdict, worlds: Sequence[Sequence[Cause]]) -> list[float]:
    """Return how probable each world is, over the verdict's own: by the causes in which the two differ.

    Without probabilities (in a verdict of before) rivals explain as much, and each world counts alike.
    """
    own, known = {_key(c) for c in verdict.causes}, _probability_of_cause(verdict)

    def likely(keys: set[str]) -> float:
        return float(np.prod([known.get(key, LEAST) for key in sorted(keys)]))

    if not known:
        return [1.0] * len(worlds)
    each = [{_key(c) for c in world} for world in worlds]
    return [likely(keys - own) / likely(own - keys) for keys in each]


def _probability_of_cause(verdict: Verdict) -> dict[str, float]:
    """Return how probable each cause is: at the place where it is most probable."""
    if not verdict.places:
        return verdict.probabilities
    out: dict[str, float] = {}
    for place in verdict.places:
        here: dict[str, float] = defaultdict(float)
        for answer in place.answers:
            for key in map(_key, answer.causes):
                here[key] += answer.probability
        out |= {key: max(p, out.get(key, 0.0)) for key, p in here.items()}
    return out


def _key(cause: Cause) -> str:
    """Return the name under which a verdict lists the probability of a cause."""
    return f"{cause.effect}:{cause.actuator}"


def interval(p: Parameter) -> tuple[float, float]:
    """Return the 90 % interval of a parameter; of one without an interval, its value twice."""
    low = p.value if p.low is None else p.value - NARROWER * (p.value - p.low)
    high = p.value if p.high is None else p.value + NARROWER * (p.high - p.value)
    return float(low), float(high)


def drawn(p: Parameter, rng: np.random.Generator, width: float = 1.0) -> Parameter:
    """Return a parameter drawn from a share of its interval as from two half normal distributions."""
    step = width * float(rng.standard_normal())
    side = p.low if step < 0.0 else p.high
    return p if side is None else p.model_copy(update={"value": p.value + abs(step) * (side - p.value) / 1.960})


def _entry(cause: Cause, width: float) -> dict[str, object]:
    known = constants_of(cause)
    named = {known.get(name, name): p for name, p in cause.parameters.items()}
    return {"effect": cause.effect, "joint": cause.actuator, **_ranges(named, width)}


def _ranges(each: Mapping[str, Parameter], width: float) -> dict[str, dict[str, Any]]:
    return {
        name: {
            "range": [float(p.value + width * (end - p.value)) for end in interval(p)],
            "value": float(p.value),
            "unit": p.unit,
        }
        for name, p in each.items()
    }
