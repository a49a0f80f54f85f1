"""What a column is by what stands beside it."""

import numpy as np
import pytest
from sher3_machines.drafting.followed import followed
from sher3_machines.drafting.grouping import once, together
from sher3_machines.drafting.roles import placed

T = np.arange(0.0, 4.0, 0.002)


def signals_of(*names):
    """Return axis -> signal -> column of columns that all move."""
    groups, _ = together(placed({name: np.sin((i + 1.0) * T) for i, name in enumerate(names)}, None, []))
    return {axis: {signal: place[0] for signal, place in found.items()} for axis, found in groups.items()}


@pytest.mark.parametrize("load", ["joint_position", "Output Angle"])
def test_of_several_encoders_the_one_that_no_drive_moves_is_that_of_the_load(load):
    (found,) = signals_of("motor_abs_position", "motor_inc_position", load).values()
    assert found == {"position": "motor_abs_position", "load": load}


def test_terms_of_a_model_are_no_effort_where_a_torque_was_applied():
    (found,) = signals_of("angle [deg]", "Gravity Torque [Nm]", "Target Torque [Nm]", "Applied Torque [Nm]").values()
    assert found == {"position": "angle [deg]", "command": "Target Torque [Nm]", "effort": "Applied Torque [Nm]"}


def test_a_friction_that_alone_was_measured_is_an_effort():
    (found,) = signals_of("angle [deg]", "Friction Torque [Nm]").values()
    assert found["effort"] == "Friction Torque [Nm]"


@pytest.mark.parametrize("beside", [("drive torque [Nm]",), ()])
def test_a_torque_that_is_applied_beside_a_measured_one_comes_from_outside(beside):
    (found,) = signals_of("angle [deg]", "Applied Torque [Nm]", *beside).values()
    assert found["applied"] == "Applied Torque [Nm]"


def test_families_that_count_from_zero_and_from_one_are_the_same_joints():
    """`tau1` is the effort of `q0`; a family of another size is left as it counts."""
    found = signals_of("q0", "q1", "q2", "tau1", "tau2", "tau3")
    assert {axis: x["effort"] for axis, x in found.items()} == {"0": "tau1", "1": "tau2", "2": "tau3"}
    assert signals_of("q0", "q1", "q2", "tau1", "tau2")["1"]["effort"] == "tau1"


def test_one_reading_in_two_units_is_one_axis():
    """A drive reports its joint in rad and its motor in turns; a second joint that moves alike stays one."""
    q = np.sin(T)
    tables = {"a1 position [rad]": q, "c1 position [rev]": q / (2.0 * np.pi), "b1 position [rev]": q}
    groups, _ = together(placed(tables, None, guesses := []))
    assert list(once(groups, tables, guesses)) == ["a_1", "b_1"]
    assert guesses == ["'c1 position [rev]' is 'a1 position [rad]' in another unit, and not used"]


@pytest.mark.parametrize(("motor", "link"), [("theta_m", "theta_l"), ("q_m", "q_l")])
def test_motor_and_link_of_an_elastic_joint_are_one_axis(motor, link):
    (found,) = signals_of(motor, link, "tau_m").values()
    assert found == {"position": motor, "load": link, "effort": "tau_m"}


def test_what_a_controller_reads_and_puts_out_is_place_and_command():
    (found,) = signals_of("Setpoint", "Input", "Output").values()
    assert found == {"position": "Input", "reference": "Setpoint", "command": "Output"}
    (found,) = signals_of("rpm", "out", "rpm_sp").values()
    assert found == {"position": "rpm", "reference": "rpm_sp", "command": "out"}


def test_what_a_controller_puts_out_leaves_places_and_drives_that_say_more():
    (found,) = signals_of("setpoint", "q", "input", "output").values()
    assert found == {"position": "q", "reference": "setpoint", "command": "input", "load": "output"}
    (found,) = signals_of("q", "out", "q_ref", "current").values()
    assert found == {"position": "q", "reference": "q_ref", "effort": "current"}


def test_a_column_without_a_number_is_no_reference():
    tables = {"t": T, "q": np.sin(T), "Servo 1 (us)": np.full(len(T), np.nan), "Servo 3 (us)": 1500.0 + np.sin(3.0 * T)}
    (found,) = together(placed(tables, "t", []))[0].values()
    assert found["reference"][0] == "Servo 3 (us)"


@pytest.mark.parametrize("drive", ["Motorspannung", "Motorstrom [A]", "pwm"])
def test_a_reference_that_stays_is_none_where_a_drive_moves_the_axis(drive):
    t = np.linspace(0.0, 10.0, 200)
    columns = {"Zeit": t, "Position": np.sin(t), "Sollposition": 0.0 * t, drive: np.cos(t)}
    found = placed(columns, "Zeit", guesses := [])
    assert {signal for signal, _ in found.values()} <= {"position", "command", "effort"}
    assert "never changes, and is not used: Sollposition" in guesses
    alone = placed({name: x for name, x in columns.items() if name != drive}, "Zeit", [])
    assert ("Sollposition", None) in alone


def test_where_a_topic_has_a_table_for_each_joint_places_of_other_topics_are_no_joints():
    joints = [f"joint_states/{joint}/{what}" for joint in ("lift", "wrist_1") for what in ("position", "effort")]
    others = ["tracker/x", "wrench/force_1", "move/feedback/status", "goal/start/joint_state.position"]
    found = signals_of(*others, *joints)
    assert found == {
        joint: {what: f"joint_states/{joint}/{what}" for what in ("position", "effort")}
        for joint in ("lift", "wrist_1")
    }


def test_parts_of_a_machine_that_say_nothing_else_are_places():
    assert signals_of("joint1", "joint_2", "Axis 3", "tcp_x") == {
        "1": {"position": "joint1"},
        "2": {"position": "joint_2"},
        "axis_3": {"position": "Axis 3"},
    }


def test_what_was_measured_is_a_place_where_nothing_is_called_one():
    found = signals_of("actual_q_0", "target_q_0", "actual_tool_accelerometer_0", "actual_main_state")
    assert found == {"0": {"position": "actual_q_0", "reference": "target_q_0"}}
    assert signals_of("command_1", "response_1") == {"1": {"position": "response_1", "reference": "command_1"}}


def test_what_lies_beside_x_lies_along_y():
    assert set(signals_of("tip_x", "tip_y")) == {"tip_x", "tip_y"}
    assert set(signals_of("x", "y")) == {"x", "y"}
    assert set(signals_of("x", "y", "u")) == {""}
    robot = signals_of("X_RIst", "Y_RIst", "A_RIst", "Y_RSol")
    assert set(robot) == {"x", "y", "a"} and robot["y"]["reference"] == "Y_RSol"


def test_a_grid_that_grows_evenly_is_no_place():
    columns = {"t": T, "X": np.linspace(0.0, 3.0, len(T)), "angle": np.sin(T)}
    assert ("X", None) not in placed(columns, "t", [])


def test_a_speed_under_two_names_is_a_speed():
    columns = {"t": T, "AngularVel": np.sin(T), "data/OutputData": np.sin(T), "data/InputData": np.cos(T)}
    found = placed(columns, "t", [])
    assert {name: signal for (name, _), (signal, _) in found.items() if name != "t"} == {
        "AngularVel": "position",
        "data/InputData": "command",
    }


@pytest.mark.parametrize("late", [0, 5, 20])
def test_a_word_for_a_torque_or_a_target_is_told_by_what_the_place_does(late):
    """`tq_0` beside `q_0`, up to 40 ms ahead of it, is what was asked for; what turns about with it is a torque."""
    q = [np.sin(T), 0.3 * np.cos(2.0 * T)]
    asked = [np.sin(T + 0.002 * late), 0.3 * np.cos(2.0 * (T + 0.002 * late))]
    force = [4.0 * np.cos(T) + 9.81, 0.2 * np.sin(2.0 * T)]
    for said, signal in ((asked, "reference"), (force, "effort")):
        tables = {f"{word}_{i}": x[i] for word, x in (("q", q), ("tq", said)) for i in range(2)}
        groups, _ = together(placed(tables, None, []))
        assert groups == {str(i): {"position": (f"q_{i}", None), signal: (f"tq_{i}", None)} for i in range(2)}


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("names", [("Current {}", "Target {}"), ("{}_curr", "{}_ref"), ("current{}", "goal{}")])
def test_current_beside_target_is_the_place_where_it_follows_and_else_a_current(names, seed):
    """Drawn axes, some rows behind what is asked of them, in drawn units; a drawn current beside the same target."""
    rng = np.random.default_rng(seed)
    late, scale = int(rng.integers(0, 20)), 10.0 ** rng.uniform(-2.0, 4.0)
    wave = np.sin(np.outer(T, rng.uniform(0.5, 1.5, 2)) + rng.uniform(0.0, 6.0, 2)).sum(axis=1)
    asked = scale * (wave + rng.uniform(-2.0, 2.0))
    place = asked[np.maximum(np.arange(len(T)) - late, 0)] + 1e-3 * scale * rng.standard_normal(len(T))
    current = rng.uniform(0.5, 5.0) * np.gradient(np.gradient(wave)) / 4e-6 + 0.2 * rng.standard_normal(len(T))
    measured, target = (name.format(axis) for name, axis in zip(names, "XX", strict=True))
    found = placed({measured: place, target: asked}, None, [])
    assert {p[0]: signal for p, (signal, _) in found.items()} == {measured: "position", target: "reference"}
    for more in ({}, {"position X": place}):
        assert placed({measured: current, target: asked, **more}, None, [])[measured, None][0] == "effort"


@pytest.mark.parametrize("seed", range(4))
def test_a_matrix_that_holds_other_columns_is_a_table_and_no_joints(seed):
    draw = np.random.default_rng(seed)
    x, zero = draw.uniform(1.0, 20.0) * np.sin(draw.uniform(3.0, 9.0) * T), draw.uniform(5.0, 20.0)
    v = np.gradient(x, T)
    force = 0.7 * v + 60.0 * np.sign(v) + draw.normal(size=len(T))
    tables = {"tout": T, "dist": x + zero, "dist1": np.column_stack([T, x]), "vel1": np.column_stack([x, v])}
    order = draw.permutation(3)
    tables["x_F"] = np.column_stack([x, v, force])[:, order]
    (found,) = together(placed(tables, "tout", []))[0].values()
    last = list(order).index(2)
    assert found == {"position": ("dist", None), "velocity": ("vel1", 1), "effort": ("x_F", last)}


def test_a_place_that_repeats_what_was_asked_of_it_is_a_joint():
    q = np.column_stack([np.sin(T), np.cos(T)])
    groups, _ = together(placed({"t": T, "q": q, "q_ref": q.copy()}, "t", []))
    assert [set(signals) for signals in groups.values()] == [{"position", "reference"}] * 2


def test_loads_alone_are_cells_and_a_scale_alone_is_a_place():
    assert signals_of("load1", "load2", "motorI") == {}
    assert signals_of("load [mm]")[""] == {"position": "load [mm]"}
    assert signals_of("laser")[""] == {"position": "laser"}


def test_z_beside_x_and_y_is_a_direction_too():
    assert set(signals_of("x", "y", "z")) == {"x", "y", "z"}


@pytest.mark.parametrize("names", [("PosTar (deg)", "Position Demand (deg)"), ("ref_deg", "planned_deg")])
@pytest.mark.parametrize(("scale", "sense", "zero"), [(1.0, 1.0, 0.0), (1e3, -1.0, 40.0)])
def test_a_place_follows_the_profile_and_not_the_target_it_was_made_of(names, scale, sense, zero):
    """Steps, and ramps to them, whatever the order, unit, sense and zero; the place is a sample behind the ramps."""
    steps = np.sign(np.sin(2.0 * T))
    ramps = np.convolve(steps, np.full(200, 1.0 / 200), mode="same")
    place = sense * scale * np.roll(ramps, 1) + zero
    for order in ((steps, ramps), (ramps, steps)):
        tables = {**dict(zip(names, order, strict=True)), "actual position [deg]": place}
        groups, _ = together(followed(placed(tables, None, []), tables))
        (found,) = groups.values()
        assert tables[found["reference"][0]] is ramps
