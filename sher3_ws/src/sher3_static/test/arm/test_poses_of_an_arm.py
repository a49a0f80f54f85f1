"""Serial arms: joint zeros found from poses measured from outside."""

import numpy as np
import pytest
from arms import ROWS, described, machine, measured
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.arm.reading import read_arm

OFFSETS = np.array([0.0, 0.008, 0.0, -0.006, 0.0, 0.0])


@pytest.fixture(scope="module")
def verdict():
    return diagnose(machine(), [measured(OFFSETS)]).verdict


def test_joint_positions_may_be_a_column_for_each_joint():
    rng, columns = np.random.default_rng(0), [{"column": f"q{i}", "unit": "deg"} for i in range(6)]
    data = {f"q{i}": rng.uniform(-70.0, 70.0, 40) for i in range(6)} | {"p": measured(OFFSETS, n=40)["poses"]}
    read = read_arm("a", data, described(joint_positions=columns))["joints"]
    np.testing.assert_allclose(read, np.radians(np.column_stack([data[f"q{i}"] for i in range(6)])))


@pytest.mark.parametrize("seed", range(3))
def test_no_link_is_a_hand_too_long(seed):
    """Poses of another arm, or of a base that moved in between, are no error of this one."""
    record = measured(np.zeros(6), seed=seed)
    record.columns["poses"][40:, :3, 3] += np.random.default_rng(seed).uniform(-0.4, 0.4, 3)
    for cause in diagnose(machine(), [record]).verdict.causes:
        assert all(abs(p.value) < 0.1 for p in cause.parameters.values() if p.unit == "m")


def test_a_nominal_arm_has_no_gap():
    found = diagnose(machine(), [measured(np.zeros(6))]).verdict
    assert found.status == "no_gap"
    assert found.notes[1].startswith("measurement frames only")
    said = {n.split(":")[0] for n in found.notes[2:] if "would have shown: encoder offset from" in n}
    assert said == {"j2", "j3", "j4", "j5"}  # the frames take the zeros of the first and the last joint


def test_joint_zeros_are_found(verdict):
    assert verdict.status == "attributed"
    found = {c.actuator: c.parameters["offset"] for c in verdict.causes if c.effect == "encoder_offset"}
    assert {name: p.value for name, p in found.items()} == {
        "j2": pytest.approx(0.008, abs=1e-3),
        "j4": pytest.approx(-0.006, abs=1e-3),
    }
    assert {p.unit for p in found.values()} == {"rad"}
    assert verdict.closure.stage.value > 0.95 and verdict.closure.tip == verdict.closure.stage


def test_the_gap_is_at_the_measured_body(verdict):
    (where,) = verdict.where
    assert (where.stage, where.actuator, where.unit, where.regime) == ("mechanism", "tip", "m", "everywhere")


def test_notes_tell_the_held_out_error_of_every_layer(verdict):
    left = [float(n.split("postures ")[1].split(" mm")[0]) for n in verdict.notes if "held-out postures" in n]
    assert len(left) == 3
    assert left[1] < 0.25 * left[0] and left[2] <= left[1]


def test_orientations_are_judged_where_their_noise_is_stated():
    """A last joint that reads 8 mrad too much turns the body about its own centre as well."""
    offsets = np.array([0.0, 0.0, 0.0, 0.008, 0.0, 0.0])
    found = diagnose(machine(noise=1.0, noise_rotation=1e-4), [measured(offsets, noise=0.0)]).verdict
    assert found.where[0].unit == "rad"


def test_left_out_joint_zeros_leave_the_gap_to_others_or_open():
    others = ["encoder_offset", "link_length_error", "rail_tilt", "joint_sag"]
    found = diagnose(machine(), [measured(OFFSETS)], without=others)
    assert found.verdict.status == "outside_library"
    assert "mm mean left" in found.verdict.notes[-1]


def test_the_wrong_number_of_joints_is_named():
    with pytest.raises(MachineError, match="do not fit the arm"):
        diagnose(machine(ROWS[:5]), [measured(np.zeros(6))])


@pytest.mark.parametrize("wrong", [0.003, 0.02])
def test_a_wrong_drawing_is_no_surer_than_the_right_one(wrong):
    """A link stated longer than it is: less is explained of a larger error, and the verdict does not say more."""
    right = diagnose(machine(), [measured(OFFSETS)]).verdict
    rows = [(a + (wrong if i == 2 else 0.0), d, alpha) for i, (a, d, alpha) in enumerate(ROWS)]
    told = diagnose(machine(rows), [measured(OFFSETS)]).verdict
    sure = {"no_gap": 2, "attributed": 1, "under_excited": 0, "outside_library": 0}
    assert sure[told.status] <= sure[right.status]
    assert told.closure.stage.low <= right.closure.stage.high
    named = {c.effect for c in told.causes}
    assert told.status != "attributed" or "link_length_error" in named
