"""Arms seen by less than a tracker of six components: positions alone, or the length of one cable alone."""

import numpy as np
import pytest
from arms import ROWS, X, Z, described
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.arm.frames import frame_columns, set_up
from sher3_static.arm.kind import KIND
from sher3_static.arm.kinematics import postures

OFFSETS = np.array([0.0, 0.008, 0.0, -0.006, 0.0, 0.0])
NOISE = 2e-4
ANCHOR = np.array([0.9, 0.3, -0.1])
"""Where the cable leaves its drum, in the base frame, m."""
SEEN = {"positions": {"column": "p", "unit": "m"}, "lengths": {"column": "p", "unit": "m"}}


def arm(sight, **more):
    return described(poses=None, **{sight: SEEN[sight]}, **more)


def seen(sight, offsets, zero=0.0, n=150, seed=0):
    """Columns of a record of the arm whose joints read `offsets` too much."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.2, 1.2, (n, len(ROWS)))
    flange = postures(KIND.known_by(arm(sight)).arm, q - offsets).tip @ X
    measured = (Z @ flange)[:, :3, 3]
    if sight == "lengths":
        measured = np.linalg.norm(flange[:, :3, 3] - ANCHOR, axis=1)
    return {"x": q, "p": measured + zero + NOISE * rng.normal(size=measured.shape)}


def verdict_of(sight, *data):
    machine = arm(sight)
    runs = [KIND.read(f"run {i}", x, machine) for i, x in enumerate(data)]
    return diagnose(KIND.machine(machine), runs).verdict


def zeros_of(verdict):
    return {c.actuator: c.parameters["offset"].value for c in verdict.causes if c.effect == "encoder_offset"}


@pytest.mark.parametrize("sight", SEEN)
def test_a_nominal_arm_has_no_gap(sight):
    assert verdict_of(sight, seen(sight, np.zeros(6))).status == "no_gap"


@pytest.mark.parametrize("sight", SEEN)
def test_joint_zeros_are_found(sight):
    verdict = verdict_of(sight, seen(sight, OFFSETS, n=300))
    assert verdict.status == "attributed"
    assert zeros_of(verdict) == {"j2": pytest.approx(0.008, abs=1e-3), "j4": pytest.approx(-0.006, abs=1e-3)}
    what = "position" if sight == "positions" else "length"
    assert any(f"{what} error on held-out postures" in note for note in verdict.notes)


@pytest.mark.parametrize("sight", SEEN)
def test_a_zero_of_its_own_in_each_run_is_no_cause(sight):
    """The tracker is set up 3 mm aside, or the cable hooked in 3 mm longer, before the second run."""
    verdict = verdict_of(sight, seen(sight, np.zeros(6)), seen(sight, np.zeros(6), zero=3e-3, seed=1))
    assert verdict.status == "no_gap"
    (note,) = [note for note in verdict.notes if "from run to run" in note]
    assert float(note.split(" differ by ")[1].split(" mm ")[0]) == pytest.approx(3.0, abs=0.1)
    verdict = verdict_of(sight, seen(sight, OFFSETS, n=200), seen(sight, OFFSETS, zero=3e-3, n=200, seed=1))
    assert set(zeros_of(verdict)) == {"j2", "j4"}


@pytest.mark.parametrize("sight", SEEN)
def test_the_columns_of_the_set_up_are_what_small_moves_do(sight):
    data, machine = seen(sight, np.zeros(6), n=40), arm(sight)
    (evidence,) = KIND.machine(machine).gather([KIND.read("a", data, machine)])
    view = evidence.table.view
    for column in range(6, 12):
        moved = view.pose.copy()
        moved[:, :3, 3] += 1e-6 * frame_columns(view)[:, :3, column]
        change = view.sight.error(view.pose, data["p"]) - view.sight.error(moved, data["p"])
        if column in view.sight.identified:
            place = list(view.sight.identified).index(column)
            np.testing.assert_allclose(change / 1e-6, set_up(view, "identified")[:, :, place], atol=1e-5)


def test_one_of_the_three_is_stated():
    with pytest.raises(ValueError, match="either `poses`, `positions` or `lengths`"):
        described(positions=SEEN["positions"])


def test_an_arm_that_hardly_moved_tells_no_frames():
    data = {name: np.repeat(x[:1], 30, axis=0) for name, x in seen("positions", np.zeros(6)).items()}
    with pytest.raises(MachineError, match="do not tell the frames"):
        verdict_of("positions", data)


def test_poses_without_an_orientation_are_told_what_they_are():
    with pytest.raises(ValueError, match="poses without an orientation are `positions`"):
        described(poses={"position": SEEN["positions"]})
