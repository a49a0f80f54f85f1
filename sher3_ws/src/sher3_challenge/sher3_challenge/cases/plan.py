"""The plan of a sealed case: faults, runs and climate, drawn from a seed before anything is simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_gap.excitation import POSTURES, excite

from sher3_challenge.errors import ChallengeError
from sher3_challenge.plants.kinds import Fault, Kind
from sher3_challenge.plants.plant import Climate, Plant, RunPlan, TruthPlant

KINDS = ("healthy", "single", "compound", "outside", "under_excited")
MIX = (0.32, 0.36, 0.12, 0.13, 0.07)
"""Shares of the kinds when they are drawn."""

RUN_SPACING_NS = 28_600_000_000
TARGETS = (0.5, 30.0)
"""Range of the fault's own part of the gap over the floor, log-uniform."""


@dataclass(frozen=True)
class CasePlan:
    """What a case will be.

    Attributes:
        name: folder name.
        kind: one of `KINDS`.
        seed: fixes the case.
        truth: the truth plant it runs on.
        faults: with the magnitude at which calibration starts; those of exact stages are final.
        targets: per fault, the aim for gap over floor (its own part); 0 where the magnitude is final.
        runs: the nine runs.
        climate: temperature.
        tracker: whether the tip is tracked.
        rivals: for an under-excited case, the effects that fit alike.
    """

    name: str
    kind: str
    seed: int
    truth: TruthPlant
    faults: tuple[Fault, ...]
    targets: tuple[float, ...]
    runs: tuple[RunPlan, ...]
    climate: Climate
    tracker: bool
    rivals: tuple[str, ...] = ()

    def plant(self, robot: Robot) -> Plant:
        """Return the plant of the case: the robot as built, with its faults."""
        return self.truth.make(robot, self.seed, self.faults, self.climate, self.tracker, region=self.region)

    def healthy(self, robot: Robot) -> Plant:
        """Return the same robot as built, without the faults."""
        return self.truth.make(robot, self.seed, (), self.climate)

    @property
    def region(self) -> tuple[float, ...]:
        """Mean position of the set-points of the repeated runs, actuator units."""
        return tuple(np.mean([run.excitation.position.mean(axis=0) for run in self.runs[:6]], axis=0).tolist())


@dataclass(frozen=True)
class Recipe:
    """An under-excited case: runs that cannot tell the rivals apart."""

    faults: tuple[str, ...]
    rivals: tuple[str, ...]
    repeated: tuple[str, str]
    singles: tuple[str, ...]
    tracker: bool = False


RECIPES = (
    # a ratio error on strokes far below a revolution: a piece of a sine looks the same
    Recipe(
        ("lead_error",), ("lead_error", "encoder_scale", "encoder_eccentricity", "transmission_ripple"),
        ("reversals_0.05", "steps_0.1"), ("steps_0.15", "reversals_0.08", "loads"),
    ),
    # a constant force in one posture at one temperature
    Recipe(
        ("force_bias", "force_drift"), ("force_bias", "force_drift"),
        ("reversals_0.15", "steps_0.2"), ("steps_0.3", "reversals_0.2", "sweep_0.1"),
    ),
    # a constant force on an axis that hardly accelerates
    Recipe(
        ("torque_constant", "gravity_load"), ("torque_constant", "gravity_load", "payload_mass"),
        ("task_0.1", "task_0.15"), ("task_0.2", "task_0.12", "task_0.18"),
    ),
    # a shift of the tip in one posture at one temperature
    Recipe(
        ("thermal_expansion",), ("thermal_expansion", "tool_offset"),
        ("reversals_0.1", "steps_0.2"), ("steps_0.15", "reversals_0.15", "sweep_0.1"), tracker=True,
    ),
)  # fmt: skip

_TIP_STAGES = ("mechanism", "structure")
_PAIRS = {
    "transport": ("steps", "sweep"),
    "controller": ("steps", "sweep"),
    "drive": ("steps", "sweep"),
    "motor_mechanics": ("reversals", "sweep"),
    "transmission": ("reversals", "sweep"),
    "mechanism": ("postures", "loads"),
    "structure": ("postures", "loads"),
    "sensing": ("postures", "loads"),
}
_ALL_PAIRS = tuple(dict.fromkeys(_PAIRS.values()))


def draw_plan(
    robot: Robot,
    seed: int,
    truth: TruthPlant,
    *,
    kind: str | None = None,
    effect: str | None = None,
    gap: tuple[float, float] = TARGETS,
) -> CasePlan:
    """Draw the plan of the case of a seed.

    Args:
        robot: nominal robot of the case.
        seed: fixes everything.
        truth: the truth plant; the same seed draws other faults from another plant's catalogue.
        kind: one of `KINDS`; drawn where None.
        effect: name of a kind of fault (its catalogue name) for a single or outside case; drawn where None.
        gap: range of the fault's own part of the gap over the floor, of single and outside cases.

    Raises:
        ChallengeError: unknown kind or effect.
    """
    rng = np.random.default_rng((20_260, seed))
    drawn = str(rng.choice(KINDS, p=MIX))
    kind = kind or drawn
    if kind not in KINDS:
        raise ChallengeError.unknown("no such kind of case", kind, KINDS)
    recipe = RECIPES[int(rng.integers(len(RECIPES)))] if kind == "under_excited" else None
    kinds = _draw_kinds(truth, kind, effect, recipe, rng)
    faults = tuple(_draw_fault(k, rng) for k in kinds)
    if recipe is not None:
        targets: tuple[float, ...] = tuple(float(rng.uniform(4, 12)) for _ in faults)
    elif kind == "compound":
        targets = tuple(0.0 if f.kind.exact else float(np.exp(rng.uniform(np.log(3), np.log(15)))) for f in faults)
    else:
        low, high = np.log(gap)
        targets = tuple(0.0 if f.kind.exact else float(np.exp(rng.uniform(low, high))) for f in faults)
    origin = 1_790_000_000_000_000_000 + int(rng.integers(10**6)) * 10**9
    warm = any(f.kind.family == "drift" for f in faults)
    climate = Climate(
        start=float(rng.uniform(21.5, 23.0)),
        rise=float(rng.uniform(2.0, 6.0) if warm else rng.uniform(0.3, 2.5)),
        constant=float(rng.uniform(60, 300)),
        origin=origin,
    )
    tracker = bool(rng.random() < 0.7) or any(f.kind.stage in _TIP_STAGES for f in faults)
    if recipe is not None:
        tracker = recipe.tracker
        climate = Climate(
            float(REFERENCE_TEMPERATURE + rng.choice([-1, 1]) * rng.uniform(1.5, 2.5)), 0.0, 100.0, origin
        )
    runs = _draw_runs(robot, faults, recipe, origin, rng)
    return CasePlan(
        f"case_{seed:05d}", kind, seed, truth, faults, targets, runs, climate, tracker, recipe.rivals if recipe else ()
    )


def _draw_kinds(
    truth: TruthPlant, kind: str, effect: str | None, recipe: Recipe | None, rng: np.random.Generator
) -> list[Kind]:
    if kind == "healthy":
        return []
    if recipe is not None:
        return [truth.library[str(rng.choice(recipe.faults))]]
    pool = truth.outside if kind == "outside" else truth.library
    if effect is not None:
        if effect not in pool:
            raise ChallengeError.unknown(f"no such {kind} fault", effect, pool)
        return [pool[effect]]
    names = sorted(pool)
    if kind != "compound":
        return [pool[str(rng.choice(names))]]
    chosen: list[Kind] = []
    while len(chosen) < (3 if rng.random() < 0.3 else 2):
        candidate = pool[str(rng.choice(names))]
        if all(candidate.effect != other.effect and candidate.effect not in other.company for other in chosen):
            chosen.append(candidate)
    return chosen


def _draw_fault(kind: Kind, rng: np.random.Generator) -> Fault:
    magnitude = kind.start
    if kind.exact:
        magnitude = float(np.exp(rng.uniform(np.log(kind.least), np.log(kind.most))))
    return Fault(kind, str(rng.choice(kind.places)), magnitude, int(rng.integers(2**31)))


def _draw_runs(
    robot: Robot, faults: Sequence[Fault], recipe: Recipe | None, origin: int, rng: np.random.Generator
) -> tuple[RunPlan, ...]:
    if recipe is not None:
        pair, singles = recipe.repeated, recipe.singles
    else:
        stages = [f.kind.stage for f in faults]
        fitting = _PAIRS[str(rng.choice(stages))] if stages and rng.random() < 0.8 else None
        pair = fitting or _ALL_PAIRS[int(rng.integers(len(_ALL_PAIRS)))]
        rest: list[str] = [n for n in ("reversals", "sweep", "steps", "loads", "postures") if n not in pair]
        # loads and postures are seen in every case, the task is kept for checking
        wanted: list[str] = [name for name in rest if name in ("loads", "postures")]
        wanted += [str(name) for name in rng.permutation([n for n in rest if n not in wanted])]
        singles = tuple(_with_amplitude(name, rng) for name in (*wanted[:2], "task"))
    labels = [pair[0]] * 3 + [pair[1]] * 3 + list(singles)
    jumps = bool(rng.random() < 0.6)
    posture = {label: str(rng.choice(list(POSTURES))) for label in dict.fromkeys(labels)}
    if recipe is not None:
        posture = dict.fromkeys(labels, next(iter(posture.values())))
    repeats: dict[str, int] = {}
    plans = []
    for n, label in enumerate(labels):
        repeat = repeats[label] = repeats.get(label, -1) + 1
        excitation = excite(label, robot, posture=posture[label], set_point_jumps=jumps)
        plans.append(RunPlan(excitation, repeat, origin + n * RUN_SPACING_NS, int(rng.integers(2**31))))
    return tuple(plans)


def _with_amplitude(name: str, rng: np.random.Generator) -> str:
    return name + str(rng.choice(["", "_0.8", "_0.6"]))
