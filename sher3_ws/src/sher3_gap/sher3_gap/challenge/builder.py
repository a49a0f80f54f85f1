"""Build sealed cases: runs into one folder, labels into another, and a manifest of hashes before anyone diagnoses."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from joblib import Parallel, delayed
from sher3_bags import Run, write_case
from sher3_description import Robot, load_robot, read_json

from .calibrate import calibrated, distinct_runs, ideal_residuals, reference_floor, residual_keys
from .oracle import StageOracle, excess, floors, oracle, stage_residuals
from .plan import TARGETS, CasePlan, ChallengeError, draw_plan
from .truth.plant import Plant

CASES, LABELS, MANIFEST = "cases", "labels", "manifest.json"
MAX_MANIFEST_BYTES = 64 << 20
STATUS = {"healthy": "no_gap", "outside": "outside_library", "under_excited": "under_excited"}


@dataclass(frozen=True)
class Request:
    """One case to build: its seed; kind and effect where not drawn; whether the effect is withheld; gap over floor."""

    seed: int
    kind: str | None = None
    effect: str | None = None
    withheld: bool = False
    gap: tuple[float, float] = TARGETS


def build_case(request: Request, cases: Path, robot: Robot | None = None) -> dict[str, Any]:
    """Build one case in `<cases>/<name>/`; return its truth, which is written nowhere.

    Args:
        request: what to build.
        cases: folder for the runs.
        robot: nominal robot in force.
    """
    robot = robot or load_robot()
    drawn = draw_plan(robot, request.seed, kind=request.kind, effect=request.effect, gap=request.gap)
    plan = calibrated(drawn, robot)
    plant = Plant(robot, plan.seed, plan.faults, plan.climate, plan.tracker, region=plan.region)
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
    stages, tips = _oracles(plan, plant, runs)
    return {
        "schema": "sher3.truth/1",
        "case": plan.name,
        "status": STATUS.get(plan.kind, "attributed"),
        "tracker": plan.tracker,
        "effects": effects,
        "rivals": list(plan.rivals),
        "oracle": {key: value.as_dict() for key, value in stages.items()},
        "tip": {key: value.as_dict() for key, value in tips.items()} if plan.tracker else None,
        "kind": plan.kind,
        "seed": plan.seed,
    }


def _oracles(plan: CasePlan, plant: Plant, runs: list[Run]) -> tuple[dict[str, StageOracle], dict[str, StageOracle]]:
    """Return the oracle of the faults' stages (all stages when healthy) and that of the tip."""
    robot = plant.robot
    chosen = distinct_runs(plan)
    nominal = Plant(robot, 0, (), plan.climate, built=False)
    built = Plant(robot, plan.seed, (), plan.climate)
    reference = ideal_residuals(nominal, chosen)
    faulty = excess(ideal_residuals(plant, chosen), reference)
    own = excess(ideal_residuals(built, chosen), reference)
    measured = floors(runs, [stage_residuals(run, robot) for run in runs], robot)
    # a stage that no repeated excitation shows has the floor of another robot
    every = oracle({**reference_floor(robot), **measured}, faulty, own)
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


def build_cases(
    cases: Path, labels: Path, requests: Iterable[Request], *, jobs: int = 1, overwrite: bool = False
) -> dict[str, str]:
    """Build cases into one folder and their labels into another; return the hashes of both by file.

    Raises:
        ChallengeError: a folder exists.
    """
    for folder in (cases, labels):
        if folder.exists():
            if not overwrite:
                raise ChallengeError("exists already", value=str(folder), remedy="choose another folder, or overwrite")
            shutil.rmtree(folder)
    truths = Parallel(n_jobs=jobs)(delayed(build_case)(request, cases) for request in requests)
    labels.mkdir(parents=True)
    for truth in truths:
        (labels / f"{truth['case']}.yaml").write_text(yaml.safe_dump(truth, sort_keys=False), encoding="utf-8")
    return hashes(cases) | hashes(labels, LABELS)


def hashes(folder: Path, prefix: str = CASES) -> dict[str, str]:
    """Return SHA-256 by file of a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {f"{prefix}/{p.relative_to(folder)}": hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def check_seal(folder: Path) -> None:
    """Check cases and labels of a finished challenge against its manifest.

    Raises:
        ChallengeError: a file is not what was sealed.
    """
    manifest = read_json(folder / MANIFEST, MAX_MANIFEST_BYTES)
    now = hashes(folder / CASES) | hashes(folder / LABELS, LABELS)
    changed = sorted(key for key in now.keys() | manifest.keys() if now.get(key) != manifest.get(key))
    if changed:
        raise ChallengeError("cases or labels changed after sealing", value=", ".join(changed[:3]), limit=len(changed))
