"""The nominal plant against recorded runs of a healthy robot, whose repeats say how close is close."""

import os
from itertools import combinations, groupby
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from sher3_bags import read_case
from sher3_sim import RunScatter, recorded_excitation, resimulate, simulate, simulate_arrays, with_effects

SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).resolve().parents[5] / "shared"))
HEALTHY = SHARED / "contract" / "practice" / "case_001"
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not HEALTHY.is_dir(), reason=f"no recorded cases under {SHARED}"),
]


@pytest.fixture(scope="module")
def case():
    return read_case(HEALTHY)


def signals(run):
    drives = run["drives/measured_js"]
    sensed = run["force/measured_cf"]
    return {
        "servo_jv": run["servo_jv"].velocity,
        "drives/setpoint_jv": run["drives/setpoint_jv"].velocity,
        "motor position": drives.position,
        "motor velocity": drives.velocity,
        "effort": drives.effort,
        "measured_js": run["measured_js"].position,
        "measured_cp": run["measured_cp"].position,
        "force": sensed.force,
        "torque": sensed.torque,
        "tracker": run["tracker/measured_cp"].position,
        "tracker rotation": run["tracker/measured_cp"].orientation,
    }


def spread(runs):
    """Mean square difference of repeats per signal: twice the floor, as that of a run and a noisy model should be."""
    out = {}
    for _, group in groupby(runs, key=lambda run: run.metadata.excitation):
        for one, other in combinations([signals(run) for run in group], 2):
            for name in one:
                out.setdefault(name, []).append(np.mean((one[name] - other[name]) ** 2, axis=0))
    return {name: np.mean(values, axis=0) for name, values in out.items()}


def test_every_stream_lies_within_the_floor(case):
    repeats, gaps = spread(case.runs), {}
    for seed, run in enumerate(case.runs):
        model = signals(resimulate(run, case.robot, seed=seed))
        for name, recorded in signals(run).items():
            gaps.setdefault(name, []).append(np.mean((recorded - model[name]) ** 2, axis=0))
    for name, values in gaps.items():
        assert np.all(np.mean(values, axis=0) < 1.15 * repeats[name]), name


def test_transport_and_controller_are_exact(case):
    for run in case.runs:
        drive = recorded_excitation(run, case.robot)
        _, out = simulate_arrays(with_effects(case.robot, []), drive)
        limits = np.array([a.limits.velocity for a in case.robot.actuators])
        law = drive.velocity + case.robot.position_gain * (drive.position - run["measured_js"].position)
        assert np.array_equal(np.clip(law, -limits, limits), run["servo_jv"].velocity)
        echo = run["drives/setpoint_jv"].velocity
        assert np.abs(echo[1:] - run["servo_jv"].velocity[:-1]).max() < 1e-14 and np.all(out["demand"][0] == 0)


def test_open_loop_on_recorded_commands_drifts_no_further_than_encoders_round(case):
    """Recorded `servo_jv` as the input: the echo is identical and the effort within its floor."""
    run = case.runs[0]
    model = resimulate(run, case.robot, open_loop=True)
    assert np.abs(model["drives/setpoint_jv"].velocity - run["drives/setpoint_jv"].velocity).max() < 1e-14
    gap = uniform_filter1d(model["drives/measured_js"].effort - run["drives/measured_js"].effort, 10, axis=0)
    assert np.all(gap.std(axis=0) < 1.2e-3 * 1.3 * np.array([a.drive.rated for a in case.robot.actuators]))


def test_scattered_runs_have_the_recorded_floor(case):
    scattered = []
    for seed, run in enumerate(case.runs):
        drive = recorded_excitation(run, case.robot)
        scattered.append(
            simulate(
                case.robot,
                drive.position,
                drive.wrench,
                seed=seed,
                setpoint_velocity=drive.velocity,
                metadata=run.metadata,
                scatter=RunScatter(),
            )
        )
    recorded, modelled = spread(case.runs), spread(scattered)
    for name in ("servo_jv", "motor position", "effort", "measured_js", "tracker"):
        ratio = np.sqrt(modelled[name] / recorded[name])
        assert np.all((ratio > 0.8) & (ratio < 1.25)), (name, ratio)
