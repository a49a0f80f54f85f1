"""A description drafted from a file, and what is guessed for it."""

from pathlib import Path

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines import MachineError, import_case, load_description, open_case
from sher3_machines.drafting.draft import draft
from written_tables import TIME, written


def test_the_draft_of_a_slide_can_be_imported(tmp_path):
    q = np.round(np.sin(TIME) / 1e-4) * 1e-4
    header = "time_ms,slide_pos [mm],slide_ref [mm],slide_current [A]"
    found = written(tmp_path, header, 1e3 * TIME, 1e3 * q, 1e3 * np.sin(TIME), np.cos(TIME))
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    (axis,) = load_description(tmp_path / "a.yaml").axes
    assert axis.motion == "linear" and axis.encoder_resolution == pytest.approx(1e-4, rel=1e-3)
    assert set(axis.signals.model_dump(exclude_none=True)) == {"position", "reference", "effort"}
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    assert open_case(tmp_path / "case")[1][0].period == pytest.approx(0.002)


def test_every_guess_is_said(tmp_path):
    found = written(tmp_path, "t,joint1_position,joint2_position", TIME, np.sin(TIME), 90.0 * np.sin(TIME))
    assert any("joint2: position in deg, because values reach 90" in x for x in found.guesses)
    assert any("joint1: position in deg" in x for x in found.guesses)  # a logger writes all its joints in one unit
    assert all(f"# guessed: {guess}\n" in found.text for guess in found.guesses)


def test_columns_that_are_spelt_otherwise_have_units_of_their_own(tmp_path):
    found = written(tmp_path, "t,wrist_angle,elbow_pos", TIME, 90.0 * np.sin(TIME), np.cos(3.0 * TIME))
    assert any("wrist: position in deg" in x for x in found.guesses)
    assert any("elbow: position in rad" in x for x in found.guesses)


@pytest.mark.filterwarnings("error")
def test_two_places_that_never_change_are_no_two_encoders_of_one_axis(tmp_path):
    """As the bounds of a motion that are logged beside it."""
    found = written(tmp_path, "t,lower_position,upper_position", TIME, 0.0 * TIME - 0.2, 0.0 * TIME + 0.5)
    assert not any("two encoders" in x for x in found.guesses)


def test_counts_are_seen(tmp_path):
    found = written(tmp_path, "t,enc", TIME, np.round(5000.0 * np.sin(TIME)))
    assert "unit: count" in found.text and any("placeholder" in x for x in found.guesses)


def test_motor_and_joint_force_and_load_are_told_by_name_and_unit(tmp_path):
    wave = np.sin(TIME)
    found = written(tmp_path, "time_s,motor_mm,joint_mm,tension_in_N,T Nut [°C]", TIME, wave, 0.9 * wave, wave, wave)
    assert {"position", "load", "effort", "temperature"} == set(signals_of(found, tmp_path))


def test_a_load_that_is_hung_on_a_held_axis_is_known(tmp_path):
    noise = 1e-3 * np.random.default_rng(0).normal(size=len(TIME))
    found = written(tmp_path, "t,q_deg,q_cmd_deg,q_link_deg,hung_load_Nm", TIME, noise, 0 * TIME, TIME, 5.0 * TIME)
    signals = signals_of(found, tmp_path)
    assert signals["applied"]["column"] == "hung_load_Nm" and signals["position"]["factor"] == 1.0


def test_a_screw_is_told_by_its_scale(tmp_path):
    """10 mm a turn: 1.59 mm a radian."""
    turns = np.round(1e4 * np.sin(TIME)) / 1e4
    signals = signals_of(written(tmp_path, "t,Motor [rev],Linear Scale [mm]", TIME, turns, 10.0 * turns), tmp_path)
    assert signals["position"]["factor"] == pytest.approx(0.01 / (2.0 * np.pi), rel=1e-3)


def test_steps_of_a_motor_and_of_its_reference_have_one_size(tmp_path):
    steps = np.round(3000.0 * np.sin(TIME))
    header = "Zeit [s],Sollposition [Schritte],Schrittzähler [Schritte],Glasmaßstab [Ink]"
    signals = signals_of(written(tmp_path, header, TIME, steps, steps, 3.0 * steps), tmp_path)
    assert signals["load"]["column"] == "Glasmaßstab [Ink]"
    assert signals["reference"]["factor"] == signals["position"]["factor"] != signals["load"]["factor"]


def test_small_angles_turn(tmp_path):
    header = "t,motor angle [deg],output angle [arcsec]"
    found = written(tmp_path, header, TIME, 100 * np.sin(TIME), 3600 * np.sin(TIME))
    assert "motion: rotary" in found.text and "a gear of 100 between" in found.text


def signals_of(found, tmp_path):
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    (axis,) = load_description(tmp_path / "a.yaml").axes
    return axis.signals.model_dump(exclude_none=True)


def test_without_a_clock_or_a_position_it_says_what_is_missing(tmp_path):
    with pytest.raises(MachineError, match=r"looks like a time.*rate"):
        written(tmp_path, "a,b", np.sin(TIME), np.sin(TIME))
    with pytest.raises(MachineError, match=r"looks like a position.*by hand"):
        written(tmp_path, "t,temperature", TIME, np.sin(TIME))


def test_a_speed_alone_is_a_place_that_is_integrated(tmp_path):
    """A motor at 60 and 120 rpm for two seconds each goes six turns; a turn a second is 2 pi rad/s."""
    rpm = np.where(TIME < 2.0, 60.0, 120.0)
    found = written(tmp_path, "Time [s],Speed [rpm],Current [A]", TIME, rpm, np.cos(TIME))
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    notes = import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    position = open_case(tmp_path / "case")[1][0].signals["axis"]["position"]
    assert position[-1] == pytest.approx(12.0 * np.pi, rel=2e-3) and position[0] == 0.0
    assert any("is a velocity; integrated" in note for note in notes)


def test_what_was_not_connected_is_no_signal_and_said(tmp_path):
    """A second encoder and a current that are zero all along say nothing; a target that stays is one."""
    nothing = np.zeros(len(TIME))
    found = written(
        tmp_path, "t,left_pos,right_pos,left_effort,left_target", TIME, np.sin(TIME), nothing, nothing, nothing
    )
    assert set(signals_of(found, tmp_path)) == {"position", "reference"}
    assert any("never changes, and is not used: right_pos, left_effort" in guess for guess in found.guesses)


@pytest.mark.parametrize(("header", "columns"), [("t,u,y", ("u", "y")), ("t,input,output", ("input", "output"))])
def test_what_drives_and_what_comes_out_are_command_and_place(tmp_path, header, columns):
    found = columns_of(tmp_path, header, TIME, np.cos(3.0 * TIME), np.sin(TIME))
    assert (found["command"], found["position"]) == columns
    assert "unit: rad" in written(tmp_path, header, TIME, np.cos(3.0 * TIME), np.sin(TIME)).text


def test_axes_named_x_y_z_slide_in_metres_or_millimetres(tmp_path):
    far = written(tmp_path, "t,X1_ActualPosition,X1_CommandPosition", TIME, 40.0 * np.sin(TIME), 40.0 * np.sin(TIME))
    near = written(tmp_path, "t,pos_x,ref_x", TIME, 2.0 * np.sin(TIME), 2.0 * np.sin(TIME))
    assert "motion: linear" in far.text and "unit: mm" in far.text
    assert "motion: linear" in near.text and "unit: mm" not in near.text


def test_a_tracker_is_the_load_of_a_wheel_and_the_place_of_what_has_no_other(tmp_path):
    wheel = written(tmp_path, "t,wheel_ticks,tracker_x_m", TIME, np.round(5000.0 * np.sin(TIME)), np.sin(TIME))
    assert set(signals_of(wheel, tmp_path)) == {"position", "load"}
    assert set(signals_of(written(tmp_path, "t,vicon_x,ref_x", TIME, np.sin(TIME), np.sin(TIME)), tmp_path)) == {
        "position",
        "reference",
    }


def columns_of(tmp_path, header, *columns):
    """Signal -> column of the one axis that a draft finds."""
    (tmp_path / "a.yaml").write_text(written(tmp_path, header, *columns).text, encoding="utf-8")
    (axis,) = load_description(tmp_path / "a.yaml").axes
    return {signal: getattr(axis.signals, signal).column for signal in axis.signals.model_dump(exclude_none=True)}


def test_what_a_drive_is_told_or_reports_is_no_place(tmp_path):
    """Names say `command` and `load`; that neither moves with the position says torque and duty."""
    q, (torque, duty) = np.sin(3.0 * TIME), np.random.default_rng(1).normal(size=(2, len(TIME)))
    found = columns_of(tmp_path, "time,pos,position_cmd,command_raw,torque,load", TIME, q, q, torque, torque, duty)
    assert found == {"position": "pos", "reference": "position_cmd", "effort": "torque"}
    found = columns_of(tmp_path, "time,pos,command_raw,torque", TIME, q, torque, torque)
    assert found == {"position": "pos", "command": "command_raw", "effort": "torque"}


def test_a_measured_speed_is_no_place(tmp_path):
    found = columns_of(tmp_path, "time_s,angle_deg,feedback_deg_s", TIME, 40.0 * np.sin(TIME), 40.0 * np.cos(TIME))
    assert found["position"] == "angle_deg"


@pytest.mark.parametrize(("header", "scale"), [("speed_rpm", 60.0 / (2.0 * np.pi)), ("omega [rad/s]", 1.0)])
@pytest.mark.parametrize("turn", [1000, 4096, 131072])
def test_a_speed_with_a_unit_tells_what_a_count_is(tmp_path, header, scale, turn):
    """An encoder of any count beside a speed: the count is no placeholder."""
    t = np.arange(2000) / 200.0
    place, speed = 12.0 * np.sin(t), 12.0 * np.cos(t)
    count = 2.0 * np.pi / turn
    columns = (t, np.round(place / count), scale * speed, np.sin(t))
    (tmp_path / "a.yaml").write_text(written(tmp_path, f"t [s],encoder,{header},duty", *columns).text, encoding="utf-8")
    (axis,) = load_description(tmp_path / "a.yaml").axes
    assert axis.signals.position.factor == pytest.approx(count, rel=2e-3)
    assert axis.encoder_resolution == pytest.approx(count, rel=2e-3) and axis.signals.velocity is not None


def test_a_draft_of_the_folder_one_stands_in_has_its_name(tmp_path, monkeypatch):
    t = 0.01 * np.arange(300)
    rows = np.column_stack([t, np.sin(t), np.sin(t)])
    folder = tmp_path / "slide"
    folder.mkdir()
    np.savetxt(folder / "log.csv", rows, delimiter=",", header="t,q,ref", comments="")
    monkeypatch.chdir(folder)
    assert "name: slide" in draft(Path()).text


@pytest.mark.parametrize(
    "header",
    [
        "time, targetSpeed, leftSpeed, leftCommand, rightSpeed, rightCommand",
        "time,set_rpm,Lspeed,LControl,Rspeed,RControl",
        "t,desired_speed,left [rpm],left_pwm,right [rpm],right_pwm",
    ],
)
def test_a_speed_that_is_asked_of_both_wheels_is_the_reference_of_each(tmp_path, header):
    t = np.arange(0.0, 10.0, 0.01)
    asked = 200.0 * np.sign(np.sin(t))
    speeds = [150.0 * np.sin(t + 0.1), 160.0 * np.sin(t + 0.2)]
    columns = (t, asked, speeds[0], 10.0 * np.cos(t), speeds[1], 12.0 * np.cos(t))
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), delimiter=",", header=header, comments="")
    names = [name.strip() for name in header.split(",")]
    drafted = parse_yaml(draft(tmp_path / "a.csv").text)["axes"]
    told = [{k: v["column"] for k, v in axis["signals"].items()} for axis in drafted]
    assert told == [
        {"position": names[2], "reference": names[1], "command": names[3]},
        {"position": names[4], "reference": names[1], "command": names[5]},
    ]


def test_a_file_for_each_signal_without_headers_has_a_clock_of_its_own_and_its_name_says_what_is_asked(tmp_path):
    """A folder of the log of a UR5: its clock was an axis, and the moment asked for the reference of the place."""
    t, folder = np.arange(0.0, 10.0, 0.008), tmp_path / "log"
    folder.mkdir()
    both = [np.sin(t), np.cos(0.7 * t)]
    for name, size in {"i_actual": 2.0, "i_target": 1.9, "m_target": 12.0, "q_actual": 1.0, "q_target": 1.01}.items():
        np.savetxt(folder / f"log_{name}.csv", np.column_stack([t, *(size * x for x in both)]), delimiter=",")
    axes = parse_yaml(draft(folder).text)["axes"]
    asked = {"position": "q_actual", "reference": "q_target", "command": "i_target", "effort": "i_actual"}
    told = [{k: v["column"] for k, v in axis["signals"].items()} for axis in axes]
    assert told == [{k: f"log_{name}/c{n}" for k, name in asked.items()} for n in (1, 2)]


@pytest.mark.parametrize(("unit", "count"), [("rad", 0.01), ("mm", 1e-5), ("deg", np.deg2rad(0.01))])
def test_the_count_of_an_encoder_is_in_the_unit_of_its_column(tmp_path, unit, count):
    """Who writes mm for the rad that was guessed has the count in mm too."""
    t = np.arange(0.0, 10.0, 0.01)
    columns = np.column_stack([t, np.round(5.0 * np.sin(t), 2)])
    np.savetxt(tmp_path / "a.csv", columns, delimiter=",", header="t,q", comments="")
    found = draft(tmp_path / "a.csv")
    assert "axis: one count of its encoder is 0.01 of the numbers recorded, its smallest step" in found.guesses
    (tmp_path / "a.yaml").write_text(found.text.replace("unit: rad", f"unit: {unit}"), encoding="utf-8")
    assert load_description(tmp_path / "a.yaml").axes[0].encoder_resolution == pytest.approx(count)


@pytest.mark.parametrize("header", ["t,q [rad]", "t,q_mrad"])
def test_a_motor_of_many_turns_has_a_draft_that_can_be_imported(tmp_path, header):
    """198 rad: a twisted string takes thirty turns."""
    found = written(tmp_path, header, TIME, (198.0 if "[rad]" in header else 198e3) * np.sin(TIME))
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    assert load_description(tmp_path / "a.yaml").axes[0].range == (-198.0, 198.0)
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    assert "range" not in written(tmp_path, "t,q [rad]", TIME, np.sin(TIME)).text.replace("# guessed", "")


@pytest.mark.parametrize(
    ("drive", "outside", "taken"),
    [("tau [Nm]", "brake torque [Nm]", True), ("tau [Nm]", "weight [g]", False), ("i [A]", "brake torque [Nm]", False)],
)
def test_a_force_from_outside_is_one_of_the_kind_of_the_drives(tmp_path, drive, outside, taken):
    wave = np.sin(TIME)
    found = written(tmp_path, f"t,q [rad],{drive},{outside}", TIME, wave, np.cos(TIME), np.sin(3.0 * TIME))
    assert ("applied:" in found.text) == taken
    assert taken or f"{outside!r} is not used, because it is in" in found.text


def test_a_speed_in_hertz_turns(tmp_path):
    """Drives give the speed of a motor in turns a second, and call that hertz."""
    found = written(
        tmp_path, "time [s],velocity setpoint [Hz],velocity measured [Hz]", TIME, np.cos(TIME), np.sin(TIME)
    )
    assert "motion: rotary" in found.text and found.text.count("unit: rev/s") == 2


@pytest.mark.parametrize(("header", "sign"), [("t,servo_us,angle_deg", 1.0), ("t,pulse width [us],pos [deg]", -1.0)])
def test_pulses_of_a_hobby_servo_are_places(tmp_path, header, sign):
    """A servo that turns 0.09 degrees for each microsecond and follows late is told a place, in its own scale."""
    pulses = np.repeat(np.random.default_rng(3).integers(1000, 2000, 20), 100).astype(float)
    asked, angle = sign * 0.09 * (pulses - 1500.0), np.zeros(len(pulses))
    for k in range(1, len(angle)):
        angle[k] = angle[k - 1] + 0.1 * (asked[k] - angle[k - 1])
    (axis,) = parse_yaml(written(tmp_path, header, TIME, pulses, np.round(angle, 1)).text)["axes"]
    reference = axis["signals"]["reference"]
    assert axis["command_law"] == {"kind": "position"} and reference["factor"] == pytest.approx(sign * 0.09, rel=0.01)
    assert reference["offset"] == pytest.approx(-sign * np.radians(135.0), rel=0.01)
    (tmp_path / "a.yaml").write_text(written(tmp_path, header, TIME, pulses, angle).text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    (signals,) = open_case(tmp_path / "case")[1][0].signals.values()
    assert np.abs(signals["reference"] - np.radians(asked)).max() < np.radians(1.0)


@pytest.mark.parametrize("header", ["t,enc1,enc2", "t,open_loop [mm],resolver [mm]", "t,phi_in,phi_out"])
def test_two_places_that_move_together_are_encoders_of_one_axis(tmp_path, header):
    """Nothing else was recorded; joints, wheels and sides of that name stay parts of their own."""
    q = np.sin(TIME)
    read = 1.002 * q + 0.003 * np.sign(np.cos(TIME))
    signals = [set(axis["signals"]) for axis in parse_yaml(written(tmp_path, header, TIME, q, read).text)["axes"]]
    assert signals == [{"position", "load"}]
    assert len(parse_yaml(written(tmp_path, "t,left_enc,right_enc", TIME, q, read).text)["axes"]) == 2


def test_what_drives_two_encoders_is_that_of_their_axis(tmp_path):
    """A command and an effort that name neither encoder belong to the one axis; those of an encoder's part them."""
    q, header = np.round(1e4 * np.sin(TIME)), "Time,Commanded Pos,Encoder 1 Pos,Encoder 2 Pos,Control Effort"
    text = written(tmp_path, header, TIME, np.sign(np.sin(TIME)), q, np.round(q / 4.0), np.cos(3.0 * TIME)).text
    (axis,) = parse_yaml(text)["axes"]
    assert set(axis["signals"]) == {"position", "load", "reference", "effort"} and axis["mass"] == "unknown"
    parts = written(tmp_path, "t,enc1,enc2,u1,u2", TIME, q, np.round(q / 4.0), np.cos(TIME), np.cos(2.0 * TIME)).text
    assert len(parse_yaml(parts)["axes"]) == 2


def test_a_command_that_is_posted_as_it_changes_drives_its_axis(tmp_path):
    """Five readings in 2000 rows of a log that merges topics; one level that is posted again drives nothing."""
    posted = np.full(len(TIME), np.nan)
    posted[200::400] = [0.1, -0.2, 0.3, -0.3, 0.0]
    (axis,) = parse_yaml(written(tmp_path, "t,angle,effort", TIME, np.sin(TIME), posted).text)["axes"]
    assert axis["signals"]["effort"]["column"] == "effort" and axis["command_law"]["kind"] == "force"
    posted[200::400] = 2.0
    (axis,) = parse_yaml(written(tmp_path, "t,angle,effort", TIME, np.sin(TIME), posted).text)["axes"]
    assert "effort" not in axis["signals"]


def test_joint_states_of_ros_are_in_rad_however_far_a_shaft_has_turned(tmp_path):
    columns = (TIME, 327.5 + np.sin(TIME), 0.3 * np.cos(TIME))
    axes = parse_yaml(written(tmp_path, "t,/joint_states/arm/position,/joint_states/pole/position", *columns).text)[
        "axes"
    ]
    assert [axis["signals"]["position"]["unit"] for axis in axes] == ["rad", "rad"] and axes[0]["range"] == [-329, 329]


def test_levels_tell_the_count_of_a_disc_of_few_lines(tmp_path):
    """Ten lines a step of 180 degrees: nine steps in all, of which half are the smallest one."""
    q = 20.0 * np.round(np.clip(9.0 * (TIME - TIME[0] - 1.0), 0.0, 9.0))
    asked = np.where(TIME - TIME[0] < 0.9, 0.0, 180.0)
    (axis,) = parse_yaml(written(tmp_path, "t,target,angle", TIME, asked, q).text)["axes"]
    assert axis["signals"]["position"]["step"] == 20.0


def test_a_refusal_lists_columns_in_the_order_in_which_names_are_given(tmp_path):
    with pytest.raises(MachineError, match=r"no column looks like a position; value t, zeta, beta"):
        written(tmp_path, "t,zeta,beta", TIME, TIME**2, np.cos(TIME))
    np.savez(tmp_path / "a.npz", kind=np.ones(1), t=TIME, zeta=TIME**2)  # a name goes to columns of samples alone
    with pytest.raises(MachineError, match=r"no column looks like a position; value t, zeta;"):
        draft(tmp_path / "a.npz")


def test_a_servo_on_a_bus_keeps_its_signs_in_a_bit_of_their_own(tmp_path):
    """Loads and speeds have a bit for the sign, currents none: the load is the effort, and the speed agrees."""
    turn, amplitude = 6.0 * TIME, 300.0
    q, v = np.round(2048.0 + amplitude * np.sin(turn)), np.round(6.0 * amplitude * np.cos(turn))
    load = np.round(150.0 * np.cos(turn) + 80.0 * np.sin(turn))
    asked = np.round(2048.0 + amplitude * np.sin(turn + 0.2))
    words = [np.where(v < 0.0, 2.0**15 - v, v), np.where(load < 0.0, 2.0**10 - load, load), np.abs(load) // 10.0]
    found = written(tmp_path, "t,target pos (1),pos (1),speed (1),load (1),current (1)", TIME, asked, q, *words)
    axis = parse_yaml(found.text)["axes"][0]["signals"]
    assert axis["effort"]["column"] == "load (1)" and axis["velocity"]["column"] == "speed (1)"
    assert any("has a sign, which 'current (1)' has not" in guess for guess in found.guesses)
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    notes = import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    assert any("1025 for -1" in note for note in notes) and any("32769 for -1" in note for note in notes)


def test_whole_numbers_of_an_encoder_are_counts_however_few(tmp_path):
    t = np.arange(400) / 100.0
    found = written(tmp_path, "t,encoder_1_pos,effort", t, np.round(120.0 * np.sin(t)), np.cos(t))
    assert parse_yaml(found.text)["axes"][0]["signals"]["position"]["unit"] == "count"


def test_a_pendulum_on_a_cart_has_a_unit_of_its_own_and_is_let_go(tmp_path):
    """The cart is held, and reads a number of some kilometres."""
    t = np.arange(3000) / 100.0
    swing, held = np.exp(-0.1 * t) * np.cos(4.7 * t), 55439.45 + 0.06 * np.random.default_rng(1).integers(0, 2, len(t))
    found = parse_yaml(written(tmp_path, "t,PendPos,CartPos", t, swing, held).text)
    pend, cart = (next(axis for axis in found["axes"] if axis["name"] == name) for name in ("pend", "cart"))
    assert pend["signals"]["position"]["unit"] == "rad" and pend["mass"] == 1.0
    assert cart["signals"]["position"]["unit"] == "count" and "mass" not in cart


def test_what_may_drive_is_said_and_no_body_is_let_go_beside_it(tmp_path):
    t = np.arange(2000) / 100.0
    swing = np.exp(-0.3 * t) * np.cos(4.0 * t)
    columns = np.column_stack([t, swing, 0.5 * np.sin(t), np.sin(5.0 * t)])
    np.savetxt(tmp_path / "a.csv", columns, delimiter=",", header="t,theta_1,theta_2,input", comments="")
    found = draft(tmp_path / "a.csv")
    assert "'input' drives one of these axes, and nothing says which" in found.text and "let go" not in found.text
    np.savetxt(tmp_path / "b.csv", columns[:, :3], delimiter=",", header="t,theta_1,theta_2", comments="")
    assert "theta_1" in draft(tmp_path / "b.csv").text and "joint1: let go" in draft(tmp_path / "b.csv").text


def test_what_was_moved_from_one_point_to_another_was_not_let_go(tmp_path):
    t = np.arange(1000) / 100.0
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, np.tanh(t)]), delimiter=",", header="t,angle", comments="")
    assert "let go" not in draft(tmp_path / "a.csv").text


def test_a_distance_slides_whatever_its_axis_is_called(tmp_path):
    t = np.arange(0.0, 5.0, 0.05)
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, 0.3 * np.sin(t)]), delimiter=",", header="t,dist", comments="")
    assert "motion: linear" in draft(tmp_path / "a.csv").text


@pytest.mark.parametrize("seed", range(4))
def test_a_place_beside_a_quaternion_is_one_of_a_pose_in_metres(seed):
    """Drawn paths of a hand: as a PoseStamped of a bag has them, and the same matrix as angles of joints."""
    rng = np.random.default_rng(seed)
    path = rng.uniform(0.1, 2.0, 3) * np.sin(np.outer(TIME, rng.uniform(0.5, 3.0, 3)))
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (len(TIME), 1))
    joints = {"hand/stamp": TIME, "hand/position": path}
    for tables, unit in ((joints, "rad"), (joints | {"hand/orientation": turn}, "m")):
        axes = parse_yaml(draft(Path("hand.mcap"), tables=tables).text)["axes"]
        assert [axis["signals"]["position"]["unit"] for axis in axes] == [unit] * 3
