"""Magnitudes: faults are scaled until their own part of the gap stands in the wanted ratio to the floor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from sher3_description import ACTUATORS, Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_gap.excitation import excite

from sher3_challenge.cases.plan import RUN_SPACING_NS, CasePlan
from sher3_challenge.oracle.oracle import Residuals, excess, floors, stage_residuals
from sher3_challenge.plants.kinds import Fault
from sher3_challenge.plants.plant import Climate, Plant, RunPlan
from sher3_challenge.plants.registry import truth_plant

ITERATIONS = 4
CLOSE_ENOUGH = 0.12
REFERENCE_SEED = 990_001


def distinct_runs(plan: CasePlan) -> tuple[RunPlan, ...]:
    """Return one run of every excitation of the case."""
    return tuple({run.excitation.label: run for run in reversed(plan.runs)}.values())


def residual_keys(fault: Fault) -> list[str]:
    """Return the residuals that show a fault: several for one that sits on all actuators."""
    stage, actuator = fault.kind.stage, fault.actuator
    if stage in ("mechanism", "structure"):
        return [f"{name}/tip" for name in (stage, *fault.kind.also)]
    if actuator == "all":
        return [f"{stage}/{name}" for name in ACTUATORS]
    if stage == "sensing" and actuator in ACTUATORS:
        return [f"transmission/{actuator}"]
    return [f"{stage}/{actuator}"]


def ideal_residuals(plant: Plant, runs: Sequence[RunPlan]) -> list[Residuals]:
    """Return the residuals of ideal runs."""
    return [stage_residuals(plant.run(run, ideal=True), plant.robot) for run in runs]


@lru_cache(maxsize=2)
def nominal_residuals(robot: Robot, name: str, climate: Climate, runs: tuple[RunPlan, ...]) -> list[Residuals]:
    """Return the residuals of ideal runs of a truth plant's robot exactly as its file says; kept for the oracle."""
    return ideal_residuals(truth_plant(name).make(robot, 0, (), climate, built=False), runs)


@lru_cache(maxsize=8)
def reference_floor(robot: Robot, name: str) -> dict[str, float]:
    """Return the floor of every stage of one healthy robot of a truth plant, from repeats of three excitations."""
    plant = truth_plant(name).make(robot, REFERENCE_SEED, (), Climate(REFERENCE_TEMPERATURE, 1.0, 200.0, 0))
    runs = []
    for n, label in enumerate(("sweep", "postures", "loads")):
        excitation = excite(label, robot, posture="p1")
        repeats = (RunPlan(excitation, k, (3 * n + k) * RUN_SPACING_NS, REFERENCE_SEED + 3 * n + k) for k in range(3))
        runs += [plant.run(repeat) for repeat in repeats]
    return floors(runs, [stage_residuals(run, robot) for run in runs], robot)


@dataclass
class Calibration:
    """Scales the faults of a plan, one at a time, against the ideal nominal robot's residuals.

    Attributes:
        robot: nominal robot.
        plan: with the faults at their start.
        iterations: at most.
        excitations: how many of the plan's are simulated, the repeated ones first; all where None.
    """

    robot: Robot
    plan: CasePlan
    iterations: int = ITERATIONS
    excitations: int | None = None

    def __post_init__(self) -> None:
        self.runs = distinct_runs(self.plan)[: self.excitations]
        self.nominal = nominal_residuals(self.robot, self.plan.truth.name, self.plan.climate, self.runs)
        self.floor = reference_floor(self.robot, self.plan.truth.name)

    def ratio(self, fault: Fault) -> float:
        """Return sqrt(D / F): the fault's own part of the gap over the floor, the largest of its residuals."""
        plan = self.plan
        plant = plan.truth.make(self.robot, 0, (fault,), plan.climate, built=False, region=plan.region)
        own = excess(ideal_residuals(plant, self.runs), self.nominal)
        return max((math.sqrt(own[key] / self.floor[key]) for key in residual_keys(fault) if key in own), default=0.0)

    def fit(self, fault: Fault, target: float) -> tuple[Fault, float]:
        """Return the fault with the magnitude that meets the target, or as near as its bounds let it, and its ratio."""
        best, best_error, reached = fault, math.inf, 0.0
        for _ in range(self.iterations):
            ratio = self.ratio(fault)
            error = abs(math.log(max(ratio, 1e-9) / target))
            if error < best_error:
                best, best_error, reached = fault, error, ratio
            if error < CLOSE_ENOUGH:
                break
            # some faults (a limit, a threshold) start late: step towards, not beyond, a factor of 8
            fault = fault.scaled_by(min(8.0, max(0.125, target / max(ratio, 1e-9))))
            if fault == best:
                break
        return best, reached


def sized(
    plan: CasePlan, robot: Robot, iterations: int = ITERATIONS, excitations: int | None = None
) -> tuple[CasePlan, dict[str, float]]:
    """Return the plan with final magnitudes, and what each fault reached: stage and actuator -> gap over floor.

    Args:
        plan: with the faults at their start; where no fault has a target it is final.
        robot: nominal robot.
        iterations: as in `Calibration`.
        excitations: as in `Calibration`.
    """
    if not any(plan.targets):
        return plan, {}
    calibration = Calibration(robot, plan, iterations, excitations)
    found = [calibration.fit(f, t) if t else (f, 0.0) for f, t in zip(plan.faults, plan.targets, strict=True)]
    reached = {f"{fault.kind.stage}/{fault.actuator}": ratio for fault, ratio in found}
    return replace(plan, faults=tuple(fault for fault, _ in found)), reached
