"""The robot model: what it accepts, what it refuses and what the refusal says."""

import os
import pickle
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sher3_common import FileError, Sher3Error, parse_yaml, read_text
from sher3_description import ACTUATORS, InvalidRobot, Robot, load_robot

SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).resolve().parents[4].parent / "shared"))


def test_nominal_robot_loads() -> None:
    robot = load_robot()
    assert tuple(actuator.name for actuator in robot.actuators) == ACTUATORS
    assert robot.delta.leg_offset == pytest.approx(0.03253547, abs=1e-8)


@pytest.mark.shared
@pytest.mark.skipif(not SHARED.is_dir(), reason=f"no shared folder at {SHARED}")
def test_contract_robot_loads_unchanged_and_equals_ours() -> None:
    path = SHARED / "contract/robot.yaml"
    assert load_robot(path) == load_robot()
    assert load_robot(path).digest() == load_robot().digest()


def test_yaml_round_trip_keeps_every_value() -> None:
    robot = load_robot().replace({"delta.link_length": 0.1 + 0.2 - 0.23})
    assert Robot.from_yaml(robot.to_yaml()) == robot
    assert Robot.from_yaml(robot.to_yaml()).digest() == robot.digest()


def test_digest_changes_with_any_value() -> None:
    robot = load_robot()
    assert robot.replace({"actuators[4].viscous": 60.0000001}).digest() != robot.digest()
    assert robot.replace({"actuators[4].viscous": 60.0}).digest() == robot.digest()


def test_robot_is_immutable() -> None:
    with pytest.raises(ValueError, match="frozen"):
        load_robot().delta.link_length = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("delta.link_length", -0.064, "> 0"),
        ("delta.link_length", 64, "<= 2"),
        ("delta.link_length", "long", "number"),
        ("delta.link_length", True, "number"),
        ("delta.link_length", None, "number"),
        ("delta.link_length", float("nan"), "finite"),
        ("delta.link_length", 0.02, "cannot be assembled"),
        ("delta.base_radius", 0.03, "cannot be assembled"),
        ("delta.leg_width", 0.07, "does not fit the ball circles"),
        ("delta.leg_azimuth", [0, 120, 240], "<= 6.28"),
        ("delta.leg_azimuth", [0.0, 0.0, 2.0], "do not span"),
        ("delta.leg_azimuth", [0.0, 2.0], "missing"),
        ("arm.tool", [0.0, 0.0, 0.0], "no length"),
        ("tilt_linkage.coupler", 0.010, "does not reach"),
        ("actuators[4].limits.upper", 0.04, "cannot follow"),
        ("actuators[4].limits.lower", -0.06, "cannot follow"),
        ("actuators[3].limits.lower", 1.0, "not below upper"),
        ("actuators[3].limits.lower", -45.0, ">= -10"),
        ("actuators[3].drive.rated", 9.0, "rated exceeds limit"),
        ("actuators[3].kind", "prismatic", "wrong kind"),
        ("actuators[0].name", "delta_2", "out of order"),
        ("force_sensor.resolution_force", 20.0, "coarser"),
        ("position_gain", 600.0, "overshoots"),
        ("control_period", 0.0, ">= 0.0001"),
        ("control_period", 1e-9, ">= 0.0001"),
        ("actuators[0].mass", 1e-12, ">= 1e-06"),
        ("actuators[0].motor_encoder", 1e-30, ">= 1e-12"),
        ("actuators[0].lead", 1e-9, ">= 1e-06"),
        ("actuators[0].drive.kp", 1e12, "<= 1"),
        ("actuators[0].limits.velocity", 1e-12, ">= 1e-06"),
        ("tracker.rate", 1e-15, ">= 0.001"),
        ("schema", "sher3.robot/2", "sher3.robot/1"),
        ("delta.link_lenght", 0.064, "unknown path"),
        ("actuators[5].mass", 0.064, "unknown path"),
    ],
)
def test_bad_value_is_refused_with_path_and_limit(path: str, value: object, says: str) -> None:
    with pytest.raises(InvalidRobot) as caught:
        load_robot().replace({path: value})
    message = str(caught.value)
    assert says in message
    assert path.split(".")[0].split("[")[0] in message
    assert caught.value.problems[0].remedy


def test_text_that_is_a_number_is_a_number() -> None:
    """YAML 1.1 reads 1e-6, without a point, as text."""
    assert load_robot().replace({"actuators[0].motor_encoder": "1e-6"}).actuators[0].motor_encoder == 1e-6


def test_every_problem_is_reported_at_once() -> None:
    data = load_robot().to_dict()
    data["delta"]["link_lenght"] = data["delta"].pop("link_length")
    data["extra"] = 1
    data["actuators"][2]["limits"]["velocity"] = 0
    with pytest.raises(InvalidRobot) as caught:
        Robot.from_dict(data)
    problems = {problem.path: problem for problem in caught.value.problems}
    assert set(problems) == {"delta.link_length", "delta.link_lenght", "extra", "actuators[2].limits.velocity"}
    assert problems["delta.link_lenght"].remedy == "did you mean 'link_length'?"
    assert "missing" in problems["delta.link_length"].what


def test_four_actuators_are_refused() -> None:
    data = load_robot().to_dict()
    del data["actuators"][1]
    with pytest.raises(InvalidRobot, match="actuators"):
        Robot.from_dict(data)


def test_errors_survive_pickling() -> None:
    with pytest.raises(InvalidRobot) as caught:
        load_robot().replace({"control_period": -1})
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value)
    assert copy.value == -1
    assert copy.to_dict()["problems"][0]["path"] == "control_period"


def test_error_message_names_value_limit_and_remedy() -> None:
    error = Sher3Error("speed too high [m/s]", value=0.02, limit=0.0122, remedy="slow down")
    assert str(error) == "speed too high [m/s]; value 0.02; limit 0.0122; slow down"


def test_missing_file_and_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no such file"):
        load_robot(tmp_path / "none.yaml")
    with pytest.raises(FileError, match="not a regular file"):
        load_robot(tmp_path)


def test_large_and_binary_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_bytes(b"a" * 2_000_000)
    with pytest.raises(FileError, match="too large") as caught:
        load_robot(path)
    assert caught.value.value == 2_000_000
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="UTF-8"):
        read_text(path)


@pytest.mark.parametrize(
    "text",
    [
        "!!python/object/apply:os.system ['true']",
        "a: [",
        "- 1",
        "",
        "a: &x [1]\nb: *x",
        "\x00",
        "a: " + "[" * 5000,
        "a: 2001-99-99",
        "a: 1\nb: 2\na: 3",
        "x: {a: 1, a: 2}",
    ],
)
def test_yaml_that_is_not_plain_data_is_refused(text: str) -> None:
    with pytest.raises(FileError):
        parse_yaml(text)


def test_whole_numbers_are_the_same_robot() -> None:
    robot = load_robot().replace({"actuators[0].viscous": 60})
    assert robot.digest() == load_robot().digest()


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.lists(st.floats(), max_size=4),
    st.dictionaries(st.text(max_size=4), st.integers(), max_size=2),
)


def paths_of(data: object, prefix: str = "") -> list[str]:
    if isinstance(data, dict):
        return [p for key, value in data.items() for p in paths_of(value, f"{prefix}.{key}" if prefix else key)]
    if isinstance(data, list):
        return [p for k, value in enumerate(data) for p in paths_of(value, f"{prefix}[{k}]")]
    return [prefix]


@settings(max_examples=300, deadline=None, derandomize=True)
@given(path=st.sampled_from(paths_of(load_robot().to_dict())), value=JUNK)
def test_any_value_at_any_place_is_taken_or_refused_in_words(path: str, value: object) -> None:
    """Whatever stands at a place of the file: a valid robot that round-trips, or an error that names a place."""
    try:
        robot = load_robot().replace({path: value})
    except InvalidRobot as error:
        assert error.problems[0].path
        assert str(error)
        return
    assert Robot.from_yaml(robot.to_yaml()) == robot
