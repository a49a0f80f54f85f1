"""The plant against labelled recorded cases: nominal gap, gap with the labelled effect in the plant, floor, closure.

    python bench/plant_practice.py [CASES] [--fit] [--json]

CASES is a folder of contract cases with `truth.yaml` labels; by default `../shared/contract/practice` or
`$SHER3_SHARED/contract/practice`. `closure` takes the parameters of the labels as they are. With `--fit` the effect's
parameters are fitted on every other run and `fitted` is the closure on the rest: can the effect take the shape at all?
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import sys
from itertools import combinations, groupby
from pathlib import Path

import numpy as np
import yaml
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize
from sher3_bags import Run, read_case
from sher3_description import ACTUATORS, Robot
from sher3_effects import plants
from sher3_sim import PlantEffect, PlantParameters, contact_wrench, recorded_excitation, simulate, with_effects
from sher3_sim.kernel.axis import AXIS_STATE
from sher3_sim.kernel.transmission import follow
from sher3_sim.replay import axis_loads

SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).resolve().parents[2] / "shared"))


def channels(run: Run) -> dict[str, np.ndarray]:
    """Return one signal per stage, chosen so that the run's own scatter hardly enters it."""
    motor = run["drives/measured_js"]
    out = {
        "transport": run["drives/setpoint_jv"].velocity[1:] - run["servo_jv"].velocity[:-1],
        "controller": run["servo_jv"].velocity,
        "motor_mechanics": uniform_filter1d(motor.effort, 10, axis=0),
        "sensing": np.column_stack([run["force/measured_cf"].force, run["force/measured_cf"].torque]),
    }
    if "tracker/measured_cp" in run and len(run["tracker/measured_cp"]):
        seen = run["tracker/measured_cp"]
        at = np.searchsorted(run["measured_cp"].stamp, seen.stamp)
        out["mechanism"] = seen.position - run["measured_cp"].position[at]
        out["tip"] = seen.position
    return out


def transmitted(run: Run, robot: Robot, plant: PlantParameters) -> np.ndarray:
    """Return (n, 5) load less what the plant's transmission makes of the recorded motor, without the zero's scatter."""
    motor, load = run["drives/measured_js"].position, run["measured_js"].position
    weight = axis_loads(robot, load, contact_wrench(run, robot))
    states = np.zeros(5, AXIS_STATE)
    model = [follow(plant.axis[i], states[i], motor[:, i].copy(), weight[:, i].copy()) for i in range(5)]
    gap = load - np.column_stack(model)
    return gap - gap.mean(axis=0)


def square(x: np.ndarray, column: int | None) -> float:
    return float(np.mean(x**2) if column is None else np.mean(x[:, column] ** 2))


def gaps(runs: list[Run], robot: Robot, effects: list[PlantEffect]) -> list[dict[str, np.ndarray]]:
    """Return recorded less modelled, per run and stage; the model neither scatters nor rounds."""
    plant = with_effects(robot, effects).without_noise()
    out = []
    for run in runs:
        drive = recorded_excitation(run, robot)
        model = simulate(
            robot, drive.position, drive.wrench, setpoint_velocity=drive.velocity, temperature=drive.temperature,
            start_stamp=run.start, parameters=plant,
        )  # fmt: skip
        recorded, modelled = channels(run), channels(model)
        gap = {stage: recorded[stage] - modelled[stage] for stage in recorded}
        out.append(gap | {"transmission": transmitted(run, robot, plant)})
    return out


def floors(runs: list[Run], robot: Robot) -> dict[str, np.ndarray]:
    """Return half the mean square difference of repeats, per stage and column."""
    out: dict[str, list[np.ndarray]] = {}
    for _, group in groupby(runs, key=lambda run: run.metadata.excitation):
        for a, b in combinations([channels(run) for run in group], 2):
            for stage in a:
                out.setdefault(stage, []).append(np.mean((a[stage] - b[stage]) ** 2, axis=0) / 2)
    # motor and load readings round independently, and nothing else scatters between them
    out["transmission"] = [np.array([(a.motor_encoder**2 + a.load_encoder**2) / 12 for a in robot.actuators])]
    return {stage: np.mean(values, axis=0) for stage, values in out.items()}


FREE = {
    "coulomb_friction": ("force", "displacement"),
    "backlash": ("width",),
    "command_delay": ("delay",),
    "transmission_ripple": ("amplitude", "phase", "base_amplitude", "base_phase"),
    "structural_compliance": ("fraction",),
    "link_length_error": ("length", "difference"),
}
"""Parameters `--fit` frees, where the label leaves some open or the truth may be shaped otherwise."""


def fitted(effect: PlantEffect, runs: list[Run], robot: Robot, signal: str, column: int | None) -> PlantEffect:
    """Return the effect with its free parameters fitted to the runs' gap of one signal (Nelder-Mead)."""
    names = FREE[effect.id]
    spec = effect.specification(effect.actuator)
    scale = np.array([1.0 if "phase" in n else getattr(effect, n) or effect.parameters[names[0]] for n in names])
    origin = np.array([getattr(effect, n) for n in names]) / scale

    def with_values(x: np.ndarray) -> PlantEffect:
        values = {n: float(np.clip(v, spec[n].low, spec[n].high)) for n, v in zip(names, x * scale, strict=True)}
        return dataclasses.replace(effect, **values)

    def loss(x: np.ndarray) -> float:
        return float(np.mean([square(gap[signal], column) for gap in gaps(runs, robot, [with_values(x)])]))

    starts = [origin + np.array([turn * ("phase" in n) for n in names]) for turn in np.arange(0, 6, 1.5)]
    best = min(starts[: 4 if "phase" in names else 1], key=loss)
    step = np.vstack([best, best + 0.3 * np.eye(len(names))])
    found = minimize(loss, best, method="Nelder-Mead", options={"initial_simplex": step, "maxfev": 120, "xatol": 1e-3})
    return with_values(found.x)


def truth_effects(truth: dict) -> list[PlantEffect]:
    """Return the labelled effects, with those of their parameters the effect here has."""
    out = []
    for entry in truth["effects"]:
        if entry["effect"] in plants():
            kind = plants()[entry["effect"]]
            known = kind.specification(entry["actuator"])
            out.append(kind(entry["actuator"], **{k: v for k, v in entry["parameters"].items() if k in known}))
    return out


def report(folder: Path, fit: bool) -> list[dict]:
    """Return the rows of the table: one per stage the label names, plus the tip; all stages of a healthy case."""
    truth = yaml.safe_load((folder / "truth.yaml").read_text())
    case = read_case(folder)
    robot, runs, effects = case.robot, list(case.runs), truth_effects(truth)
    floor, nominal = floors(runs, robot), gaps(runs, robot, [])
    labelled = gaps(runs, robot, effects) if effects else nominal
    stages = [(e["stage"], e["actuator"]) for e in truth["effects"]] or [(stage, "all") for stage in floor]
    if truth["effects"] and "tip" in floor:
        stages.append(("tip", "tip"))
    rows = []
    for stage, actuator in stages:
        signal = "mechanism" if stage == "structure" else stage
        if signal not in floor:
            continue
        column = ACTUATORS.index(actuator) if signal not in ("mechanism", "tip") and actuator in ACTUATORS else None
        l0 = float(np.mean([square(gap[signal], column) for gap in nominal]))
        l1 = float(np.mean([square(gap[signal], column) for gap in labelled]))
        f = float(np.mean(floor[signal]) if column is None else floor[signal][column])
        oracle = truth["oracle"].get(f"{stage}/{actuator}", {}).get("closure")
        if stage == "tip" and truth["tip"]:
            oracle = truth["tip"]["tip_free"]["closure"]
        closure = (l0 - l1) / (l0 - f) if effects and l0 > f else None
        name = "+".join(effect.id for effect in effects) or truth["status"]
        rows.append(
            {"case": folder.name, "effect": name, "stage": stage, "actuator": actuator, "gap": l0**0.5,
             "gap_with_effect": l1**0.5, "floor": f**0.5, "closure": closure, "oracle": oracle,
             "fitted": None, "parameters": None}
        )  # fmt: skip
        if fit and stage != "tip" and len(effects) == 1 and effects[0].id in FREE:
            found = fitted(effects[0], runs[::2], robot, signal, column)
            before = np.mean([square(gap[signal], column) for gap in nominal[1::2]])
            after = np.mean([square(gap[signal], column) for gap in gaps(runs[1::2], robot, [found])])
            rows[-1]["fitted"] = float((before - after) / (before - f))
            rows[-1]["parameters"] = {name: getattr(found, name) for name in FREE[found.id]}
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path, nargs="?", default=SHARED / "contract" / "practice")
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    folders = sorted(path.parent for path in arguments.cases.glob("*/truth.yaml"))
    if not folders:
        sys.exit(f"no labelled cases under {arguments.cases}; name a folder of cases")
    rows = [row for folder in folders for row in report(folder, arguments.fit)]
    if arguments.json:
        print(json.dumps(rows, indent=1))
        return
    names = f"{'case':9} {'effect':22} {'stage':16} {'actuator':9}"
    print(names, f"{'gap':>9} {'with':>9} {'floor':>9} closure  oracle  fitted parameters")
    for r in rows:
        ratios = " ".join(f"{r[k]:7.3f}" if r[k] is not None else "      -" for k in ("closure", "oracle", "fitted"))
        values = " ".join(f"{name}={value:.3g}" for name, value in (r["parameters"] or {}).items())
        numbers = f"{r['gap']:9.2e} {r['gap_with_effect']:9.2e} {r['floor']:9.2e}"
        print(f"{r['case']:9} {r['effect']:22} {r['stage']:16} {r['actuator']:9} {numbers} {ratios} {values}")


if __name__ == "__main__":
    main()
