"""Build a case: its runs into a folder, its truth handed back and written nowhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sher3_bags import Run, write_case
from sher3_description import Robot, load_robot

from sher3_challenge.cases.calibrate import (
    distinct_runs,
    ideal_residuals,
    nominal_residuals,
    reference_floor,
    residual_keys,
    sized,
)
from sher3_challenge.cases.plan import TARGETS, CasePlan, draw_plan
from sher3_challenge.oracle.oracle import StageOracle, excess, floors, oracle, stage_residuals
from sher3_challenge.plants.plant import Plant
from sher3_challenge.plants.registry import truth_plant

STATUS = {"healthy": "no_gap", "outside": "outside_library", "under_excited": "under_excited"}


@dataclass(frozen=True)
class Request:
    """One case to build.

    Attributes:
        seed: fixes the case.
        kind, effect: where they are not drawn.
        withheld: whether the diagnosis has to do without the effect.
        gap: range of gap over floor.
        plant: name of the truth plant.
    """

    seed: int
    kind: str | None = None
    effect: str | None = None
    withheld: bool = False
    gap: tuple[float, float] = TARGETS
    plant: str = "lumped"


def build_case(request: Request, cases: Path, robot: Robot | None = None) -> dict[str, Any]:
    """Build one case in `<cases>/<name>/`; return its truth, which is written nowhere.

    Args:
        request: what to build.
        cases: folder for the runs.
        robot: nominal robot in force.
    """
    robot = robot or load_robot()
    truth_of = truth_plant(request.plant)
    drawn = draw_plan(robot, request.seed, truth_of, kind=request.kind, effect=request.effect, gap=request.gap)
    plan, _ = sized(drawn, robot)
    plant = plan.plant(robot)
    runs = [plant.run(run) for run in plan.runs]
    truth = label(plan, plant, runs)
    if request.withheld:
        truth = withhold(truth)
    write_case(cases / plan.name, runs, robot)
    return truth


def withhold(truth: Mapping[str, Any]) -> dict[str, Any]:
    """Return the truth of a case whose effects the diagnosis has to do without: they lie outside its library."""
    effects = [{**effect, "family": "outside", "withheld": effect["family"]} for effect in truth["effects"]]
    without = sorted({effect["effect"] for effect in truth["effects"]})
    return {**truth, "status": "outside_library", "kind": "withheld", "effects": effects, "without": without}


def label(plan: CasePlan, plant: Plant, runs: list[Run]) -> dict[str, Any]:
    """Return the truth of a case, schema `sher3.truth/1`."""
    stages, tips = _oracles(plan, plant, runs)
    return {
        **described(plan, plant),
        "oracle": {key: value.as_dict() for key, value in stages.items()},
        "tip": {key: value.as_dict() for key, value in tips.items()} if plan.tracker else None,
    }


def described(plan: CasePlan, plant: Plant) -> dict[str, Any]:
    """Return the truth of a case without what an oracle would close."""
    effects = [
        {
            "stage": fault.kind.stage,
            "also": list(fault.kind.also),
            "actuator": fault.actuator,
            "effect": fault.kind.effect,
            "family": fault.kind.family,
            "parameters": {key: float(value) for key, value in values.items()},
            "company": list(fault.kind.company),
            "fault": fault.kind.name,
        }
        for fault, values in zip(plan.faults, plant.parameters(), strict=True)
    ]
    return {
        "schema": "sher3.truth/1",
        "case": plan.name,
        "status": STATUS.get(plan.kind, "attributed"),
        "tracker": plan.tracker,
        "effects": effects,
        "rivals": list(plan.rivals),
        "level": {"built": plant.level.built, "shape": plant.level.shape},
        "kind": plan.kind,
        "seed": plan.seed,
        "plant": plan.truth.name,
    }


def _oracles(plan: CasePlan, plant: Plant, runs: list[Run]) -> tuple[dict[str, StageOracle], dict[str, StageOracle]]:
    """Return the oracle of the faults' stages (all stages when healthy) and that of the tip."""
    robot = plant.robot
    chosen = distinct_runs(plan)
    reference = nominal_residuals(robot, plan.truth.name, plan.climate, chosen)
    faulty = excess(ideal_residuals(plant, chosen), reference)
    own = excess(ideal_residuals(plan.healthy(robot), chosen), reference) if plan.faults else faulty
    measured = floors(runs, [stage_residuals(run, robot) for run in runs], robot)
    # A stage that no repeated excitation shows has the floor of another robot.
    every = oracle({**reference_floor(robot, plan.truth.name), **measured}, faulty, own)
    tips = {name: every.pop(f"{name}/tip") for name in ("tip", "tip_free")}
    if not plan.faults:
        return every, tips
    stages: dict[str, StageOracle] = {}
    for fault in plan.faults:
        keys = [key for key in residual_keys(fault) if key in every]
        if keys:
            worst = max(keys, key=lambda key: (every[key].gap_over_floor or 0.0, every[key].L0))
            stages[f"{fault.kind.stage}/{fault.actuator}"] = every[worst]
    return stages, tips
