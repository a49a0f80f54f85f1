"""A force sensor under known weights at known levers, and readings that a controller gives in the base frame."""

import numpy as np
import pytest
from scipy.constants import g
from scipy.spatial.transform import Rotation
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.kind import KIND

NOISE = np.repeat([0.02, 0.002], 3)
BIAS = np.array([1.0, 0.0, -2.0, 0.05, 0.0, 0.0])
COLUMNS = {"force": {"column": "f", "unit": "N"}, "torque": {"column": "t", "unit": "N*m"}}


def described(**more):
    return SensorDescription.model_validate({"kind": "force_sensor", "name": "ft", **COLUMNS, **more})


APPLIED = described(
    applied={
        "weight": {"column": "kg", "unit": "kg"},
        "direction": {"column": "along", "unit": "1"},
        "lever": {"column": "at", "unit": "mm"},
    }
)


def weighed(bias=0.0, matrix=None, turn=None, sign=1.0, n=120, seed=1):
    """Weights up to 5 kg that pull along each axis, either way, at levers up to 100 mm."""
    rng = np.random.default_rng(seed)
    along = np.tile(np.vstack([np.eye(3), -np.eye(3)]), (n // 6, 1))
    kg, at = rng.choice([0.0, 1.0, 2.0, 5.0], n), rng.choice([-0.1, -0.05, 0.0, 0.05, 0.1], (n, 3))
    force = kg[:, None] * g * along
    torque = np.cross(at, force)
    if turn is not None:
        force, torque = turn.apply(force), turn.apply(torque)
    wrench = sign * np.hstack([force, torque]) @ (np.eye(6) if matrix is None else matrix).T
    wrench = wrench + bias + rng.normal(0.0, NOISE, (n, 6))
    return {"f": wrench[:, :3], "t": wrench[:, 3:], "kg": kg, "along": 3.0 * along, "at": 1e3 * at}


def verdict_of(*data, known=APPLIED):
    runs = [KIND.read(f"run {i}", x, known) for i, x in enumerate(data)]
    return diagnose(KIND.machine(known), runs).verdict


def effects(verdict):
    return sorted(c.effect for c in verdict.causes)


def test_a_healthy_sensor_has_no_gap():
    assert sum(verdict_of(weighed(seed=seed)).status != "no_gap" for seed in range(8)) <= 1


def test_a_bias_under_weights():
    (cause,) = verdict_of(weighed(bias=BIAS)).causes
    assert cause.effect == "force_bias"
    assert cause.parameters["fz"].value == pytest.approx(-2.0, abs=0.02)


def test_scale_and_crosstalk_under_weights():
    verdict = verdict_of(weighed(matrix=np.diag([1.0, 1.0, 1.06, 1.0, 1.0, 1.0])))
    assert effects(verdict) == ["force_scale"]
    assert verdict.causes[0].parameters["relative"].value == pytest.approx(0.06, abs=0.005)
    matrix = np.eye(6)
    matrix[0, 1] = 0.05
    assert effects(verdict_of(weighed(matrix=matrix))) == ["force_crosstalk"]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"turn": Rotation.from_euler("z", 90, degrees=True)}, "90 degrees about (0, 0, 1)"),
        ({"turn": Rotation.from_euler("x", 30, degrees=True)}, "30 degrees about (1, 0, 0)"),
        ({"sign": -1.0}, "reads the reaction"),
    ],
    ids=["z", "by 30", "reaction"],
)
def test_a_wrong_frame_under_weights(wrong, said):
    verdict = verdict_of(weighed(**wrong))
    assert effects(verdict) == ["sensor_frame"]
    assert any(said in note for note in verdict.notes), verdict.notes


def test_a_zero_of_its_own_in_each_run_is_no_cause():
    """The amplifier was set to zero again before the second run: 3 N are none of the sensor's errors."""
    again = np.array([0.0, 0.0, 3.0, 0.0, 0.0, 0.0])
    verdict = verdict_of(weighed(bias=-again / 2), weighed(bias=again / 2, seed=2))
    assert verdict.status == "no_gap"
    assert any("zeros of fz differ by 3 N from run to run" in note for note in verdict.notes), verdict.notes


def test_weights_in_newtons_along_one_direction():
    """Weights that hang on one arm, one way up: the zero of that force is found all the same."""
    data = weighed(bias=BIAS)
    known = described(
        applied={
            "weight": {"column": "n", "unit": "N"},
            "direction": [0.0, 0.0, -1.0],
            "lever": {"column": "at", "unit": "mm"},
        }
    )
    force = np.outer(data["kg"] * g, [0.0, 0.0, -1.0])
    noise = np.random.default_rng(5).normal(0.0, NOISE, (len(force), 6))
    wrench = np.hstack([force, np.cross(1e-3 * data["at"], force)]) + BIAS + noise
    data |= {"f": wrench[:, :3], "t": wrench[:, 3:], "n": data["kg"] * g}
    (cause,) = verdict_of(data, known=known).causes
    assert cause.effect == "force_bias" and cause.parameters["fx"].value == pytest.approx(1.0, abs=0.02)


def test_weights_that_tell_nothing_are_refused():
    same = {name: np.repeat(x[:1], 40, axis=0) for name, x in weighed().items()}
    same |= {name: weighed(n=42)[name][:40] for name in ("f", "t")}
    with pytest.raises(MachineError, match="too few different loads; value 1; limit 3; apply more weights"):
        verdict_of(same)
    nowhere = weighed()
    row = int(np.flatnonzero(nowhere["kg"])[2])
    nowhere["along"][row] = 0.0
    with pytest.raises(MachineError, match=rf"a weight pulls nowhere; value row {row + 1}"):
        verdict_of(nowhere)


def hung(bias=0.0, base=False, n=120, seed=1):
    """Readings of a sensor with a load of 1.5 kg that is turned, in its own frame or in the base's."""
    turn = Rotation.random(n, random_state=seed)
    down = turn.inv().apply([0.0, 0.0, -g])
    noise = np.random.default_rng(seed).normal(0.0, NOISE, (n, 6))
    wrench = np.hstack([1.5 * down, np.cross(1.5 * np.array([0.01, -0.02, 0.06]), down)]) + bias + noise
    force, torque = (turn.apply(x) if base else x for x in (wrench[:, :3], wrench[:, 3:]))
    return {"f": force, "t": torque, "q": turn.as_quat()}


def test_readings_in_the_base_frame_are_turned_into_the_sensors():
    more = {
        "orientation": {"quaternion": {"column": "q", "unit": "1"}},
        "load": {"mass": 1.5, "centre": [0.01, -0.02, 0.06]},
    }
    in_base, own = described(expressed_in="base", **more), described(**more)
    assert verdict_of(hung(base=True), known=in_base).status == "no_gap"
    (cause,) = verdict_of(hung(BIAS, base=True), known=in_base).causes
    (same,) = verdict_of(hung(BIAS), known=own).causes
    assert cause.effect == same.effect == "force_bias"
    assert cause.parameters["fz"].value == pytest.approx(same.parameters["fz"].value, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("stated", ["sensor", "base"])
@pytest.mark.parametrize("mass", [1.5, "unknown"])
def test_the_frame_of_readings_is_told_from_how_the_load_turns_whatever_was_stated(seed, stated, mass):
    rng = np.random.default_rng(seed)
    bias = rng.choice([0.0, 1.0]) * rng.normal(0.0, [5.0] * 3 + [0.5] * 3)
    load = {"mass": mass, **({} if mass == "unknown" else {"centre": [0.01, -0.02, 0.06]})}
    more = {"orientation": {"quaternion": {"column": "q", "unit": "1"}}, "load": load}
    for base in (False, True):
        found = verdict_of(hung(bias, base=base, n=40, seed=seed), known=described(expressed_in=stated, **more))
        assert [c.effect for c in found.causes] == ["force_bias"] * bool(bias.any())
        assert any("expressed_in" in note for note in found.notes) == (base is (stated == "sensor"))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, "state either `orientation`"),
        ({"applied": APPLIED.applied, "expressed_in": "base"}, "base frame need the `orientation`"),
    ],
)
def test_what_cannot_be_told_is_refused(more, said):
    with pytest.raises(ValueError, match=said):
        described(**more)


WRENCHES = described(
    applied={"force": {"column": "known_f", "unit": "N"}, "torque": {"column": "known_t", "unit": "N*m"}}
)


def in_wrenches(data):
    """The same loads as wrenches."""
    force = data["kg"][:, None] * g * data["along"] / 3.0
    return {**data, "known_f": force, "known_t": np.cross(1e-3 * data["at"], force)}


@pytest.mark.parametrize("known", [APPLIED, WRENCHES], ids=["weights", "wrenches"])
def test_known_wrenches_are_as_good_as_weights_at_levers(known):
    data = in_wrenches(weighed(matrix=np.diag([1.0, 1.0, 1.06, 1.0, 1.0, 1.0])))
    data["along"][data["kg"] == 0.0] = 0.0  # nothing pulls, and nowhere
    (cause,) = verdict_of(data, known=known).causes
    assert cause.effect == "force_scale" and cause.parameters["relative"].value == pytest.approx(0.06, abs=0.005)


@pytest.mark.parametrize(
    "applied",
    [
        {"force": COLUMNS["force"]},
        {"weight": {"column": "kg", "unit": "kg"}},
        {**APPLIED.applied.__dict__, "force": COLUMNS["force"], "torque": COLUMNS["torque"]},
    ],
    ids=["half", "nowhere", "both"],
)
def test_either_weights_or_wrenches_are_known(applied):
    with pytest.raises(ValueError, match="state either `weight` and `direction`, or both `force` and `torque`"):
        described(applied=applied)
