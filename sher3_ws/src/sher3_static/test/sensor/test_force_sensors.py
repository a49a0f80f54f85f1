"""A force sensor with known errors under a known load: each is found, with its size and its frame."""

import numpy as np
import pytest
from scipy.constants import g
from scipy.spatial.transform import Rotation
from sher3_diagnosis import diagnose
from sher3_diagnosis.judge.costs import Costs
from sher3_machines import MachineError
from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.draft import wrench_of
from sher3_static.sensor.frames import frames
from sher3_static.sensor.kind import KIND
from sher3_static.sensor.reading import read_sensor, scatter
from sher3_static.sensor.view import TurnedView

MASS, CENTRE = 1.5, np.array([0.01, -0.02, 0.06])
NOISE = np.repeat([0.02, 0.002], 3)


def readings(
    bias=0.0, mass=MASS, centre=CENTRE, matrix=None, drift=0.0, turn=None, inverted=False, sign=1.0, n=120, seed=1
):
    """Columns of a record: wrench, orientation as a quaternion."""
    rng = np.random.default_rng(seed)
    orientation = Rotation.random(n, random_state=seed)
    down = orientation.inv().apply([0.0, 0.0, -g])
    wrench = np.hstack([mass * down, np.cross(mass * centre, down)])
    if turn is not None:
        wrench = np.hstack([turn.apply(wrench[:, :3]), turn.apply(wrench[:, 3:])])
    wrench = sign * wrench @ (np.eye(6) if matrix is None else matrix).T
    wrench = wrench + bias + drift * np.linspace(0.0, 1.0, n)[:, None] + rng.normal(0.0, NOISE, (n, 6))
    stated = orientation.inv() if inverted else orientation
    return {"f": wrench[:, :3], "t": wrench[:, 3:], "q": stated.as_quat()}


def description(mass=MASS, centre=CENTRE):
    load = {"mass": mass, **({} if mass == "unknown" else {"centre": tuple(centre)})}
    return SensorDescription.model_validate(
        {
            "kind": "force_sensor",
            "name": "ft",
            "force": {"column": "f", "unit": "N"},
            "torque": {"column": "t", "unit": "N*m"},
            "orientation": {"quaternion": {"column": "q", "unit": "1"}},
            "load": load,
        }
    )


def verdict_of(data, **load):
    described = description(**load)
    return diagnose(KIND.machine(described), [read_sensor("a", data, described)]).verdict


def effects(verdict):
    return sorted(c.effect for c in verdict.causes)


def test_a_healthy_sensor_has_no_gap():
    assert sum(verdict_of(readings(seed=seed)).status != "no_gap" for seed in range(8)) <= 1


def test_a_bias_is_found_by_component():
    (cause,) = verdict_of(readings(bias=np.array([1.0, 0.0, -2.0, 0.05, 0.0, 0.0]))).causes
    assert cause.effect == "force_bias"
    assert cause.parameters["fz"].value == pytest.approx(-2.0, abs=0.02) and cause.parameters["fz"].unit == "N"
    assert cause.parameters["tx"].value == pytest.approx(0.05, abs=0.002) and cause.parameters["tx"].unit == "N*m"


def test_a_heavier_load_and_its_centre():
    verdict = verdict_of(readings(mass=1.8, centre=np.array([0.01, 0.0, 0.08])))
    assert effects(verdict) == ["tool_gravity"]
    assert verdict.causes[0].parameters["mass"].value == pytest.approx(0.3, abs=0.01)
    assert any("1.8 kg, centre (10." in note for note in verdict.notes)


def test_crosstalk_and_scale_under_a_known_load():
    matrix = np.eye(6)
    matrix[0, 1] = 0.05
    assert effects(verdict_of(readings(matrix=matrix))) == ["force_crosstalk"]
    verdict = verdict_of(readings(matrix=np.diag([1.0, 1.0, 1.06, 1.0, 1.0, 1.0])))
    assert effects(verdict) == ["force_scale"]
    assert verdict.causes[0].parameters["relative"].value == pytest.approx(0.06, abs=0.005)


def test_a_drift_over_the_record():
    verdict = verdict_of(readings(drift=np.array([0.0, 0.0, 0.8, 0.0, 0.0, 0.0])))
    assert effects(verdict) == ["force_drift"]
    assert verdict.causes[0].parameters["fz"].value == pytest.approx(0.8, abs=0.03)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"turn": Rotation.from_euler("z", 90, degrees=True)}, "90 degrees about (0, 0, 1)"),
        ({"turn": Rotation.from_euler("x", 180, degrees=True)}, "180 degrees about (1, 0, 0)"),
        ({"turn": Rotation.from_euler("z", 30, degrees=True)}, "30 degrees about (0, 0, 1)"),
        ({"turn": Rotation.from_rotvec(np.radians(50.0) * np.array([0.6, 0.0, 0.8]))}, "50 degrees about (0.6, "),
        ({"inverted": True}, "orientation is stated the other way round"),
        ({"sign": -1.0}, "reads the reaction"),
    ],
    ids=["z", "x", "by 30", "askew", "inverted", "reaction"],
)
@pytest.mark.parametrize("mass", [MASS, "unknown"])
def test_a_wrong_frame_is_named(wrong, said, mass):
    verdict = verdict_of(readings(**wrong), mass=mass)
    assert "sensor_frame" in effects(verdict)
    assert any(said in note for note in verdict.notes), verdict.notes


def test_a_sensor_mounted_askew_by_five_degrees():
    verdict = verdict_of(readings(turn=Rotation.from_rotvec([0.0, 0.0, np.radians(5.0)])))
    assert effects(verdict) == ["sensor_frame"]
    assert abs(verdict.causes[0].parameters["rz"].value) == pytest.approx(np.radians(5.0), rel=0.03)
    assert any("5 degrees about" in note for note in verdict.notes)


def test_a_load_that_nobody_stated_is_identified():
    verdict = verdict_of(readings(bias=np.array([1.0, 0, 0, 0, 0, 0])), mass="unknown")
    assert effects(verdict) == ["force_bias"]
    assert any("load on the sensor: 1.5 kg, centre (10." in note for note in verdict.notes)
    assert any("scale of all forces cannot be told" in note for note in verdict.notes)


def test_several_errors_at_once():
    data = readings(
        bias=np.array([1.0, 0, 0, 0, 0.1, 0]), drift=np.array([0, 0, 0.8, 0, 0, 0]), mass=1.8, centre=0.5 * CENTRE
    )
    assert effects(verdict_of(data)) == ["force_bias", "force_drift", "tool_gravity"]


def test_records_that_tell_nothing_are_refused():
    flat = readings()
    flat["q"] = Rotation.from_euler("z", np.linspace(0, 6, 120)[:, None]).as_quat()
    with pytest.raises(MachineError, match=r"too alike.*upside down"):
        verdict_of(flat)
    dead = readings()
    dead["t"][:, 1] = 0.0
    with pytest.raises(MachineError, match=r"ty never changes; value 0"):
        verdict_of(dead)
    with pytest.raises(MachineError, match=r"too few readings; value 12"):
        verdict_of(readings(n=12))


@pytest.mark.parametrize("order", [("current", "goal"), ("target", "measured")])
def test_a_sensor_is_turned_as_was_measured_and_not_as_was_asked_for(order):
    """An arm's log of poses and goals, the goal before or behind."""
    names = [f"{who}_orientation_{x}" for who in order for x in "xyzw"]
    tables = {n: np.zeros(9) for n in [*names, *(f"{f}_{x}" for f in ("force", "torque") for x in "xyz")]}
    assert wrench_of(tables)["quaternion"] == [n for n in names if n.startswith(("current", "measured"))]


def test_the_floor_is_the_noise_in_every_frame():
    data = readings(inverted=True, bias=3.0, n=400)
    wrench = np.hstack([data["f"], data["t"]])
    turn = Rotation.from_quat(data["q"]).as_matrix()
    view = TurnedView(np.zeros(400), wrench, turn, MASS, MASS * CENTRE, False)
    found = scatter(view, np.zeros(400, dtype=int))
    assert found == pytest.approx(NOISE, rel=0.15)


def test_the_stated_frame_is_the_first_of_them():
    assert str(frames()[0]) == "as stated" and len(frames()) == 96


def test_odds_decide_what_a_sensor_has_and_costs_count():
    bias, described = np.array([0.0, 0.0, 2.0, 0.0, 0.0, 0.0]), description()
    runs = [read_sensor("a", readings(bias), described)]
    verdict = diagnose(KIND.machine(described), runs).verdict
    (first, *_) = verdict.places
    assert (verdict.status, first.bet.causes[0].effect) == ("attributed", "force_bias")
    assert sum(a.probability for a in first.answers) + first.other == pytest.approx(1.0)
    assert verdict.costs == {"name": 1.0, "abstain": 1.0, "miss": 1.0}
    dear = diagnose(KIND.machine(described), runs, costs=Costs(name=1e6)).verdict
    assert dear.status == "outside_library" and dear.places[0].bet.causes[0].effect == "force_bias"
