"""Names of columns as people write them: which signal, of which axis."""

import pytest
from sher3_machines.drafting.grouping import together
from sher3_machines.drafting.names import bare_and_unit, parse, tells_time


@pytest.mark.parametrize(
    ("column", "signal", "axis"),
    [
        ("q", "position", ""),
        ("q_ref", "reference", ""),
        ("tau", "effort", ""),
        ("actual_q_2", "position", "2"),
        ("target_q_2", "reference", "2"),
        ("actual_qd_2", "velocity", "2"),
        ("actual_current_2", "effort", "2"),
        ("Soll [mm]", "reference", ""),
        ("Referência", "reference", ""),
        ("Saída", "position", ""),
        ("Esforço", "command", ""),
        ("Erro", None, ""),
        ("Ist [mm]", "position", ""),
        ("Strom [A]", "effort", ""),
        ("present_position", "position", ""),
        ("present_current", "effort", ""),
        ("PositionCmptd3", "reference", "3"),
        ("planned_q2", "reference", "2"),
        ("current_position", "position", ""),
        ("goal_position", "reference", ""),
        ("Tgt_pos [mm]", "reference", ""),
        ("pos_estimate", "position", ""),
        ("Iq_setpoint", "command", ""),
        ("a1 q-axis [A]", "effort", "a_1_axis"),
        ("a1 q-axis cmd [A]", "command", "a_1_axis"),
        ("position [V]", None, ""),
        ("encoder_V", None, ""),
        ("theta_m", "position", ""),
        ("q_l", "load", ""),
        ("load cell weight [g]", "applied", "cell"),
        ("excitation frequency [Hz]", None, ""),
        ("velocity setpoint [Hz]", "asked speed", ""),
        ("axis1_cmd_pos", "reference", "axis_1"),
        ("motor_pos", "position", ""),
        ("load_pos", "load", ""),
        ("pos_x", "position", "x"),
        ("ref_x", "reference", "x"),
        ("slideCurrent", "effort", "slide"),
        ("joint_states/elbow/position", "position", "elbow"),
        ("curr_data/Joint_1", "effort", "1"),
        ("D/speed_rpm", "velocity", "d"),
        ("dataQ/c3", "position", "3"),
        ("excit_vel_record/c0", "velocity", "0"),
        ("run/Sensor1", None, "1"),
        ("controller/reference/positions[0]", "reference", "0"),
        ("motor_temperature", "temperature", ""),
        ("force_N", "effort", ""),
        ("drive_force_N", "effort", "drive"),
        ("iq_A", "effort", ""),
        ("u_V", "command", ""),
        ("enc_A", "position", "a"),
        ("displacement(um)", "position", ""),
        ("Sollposition [Schritte]", "reference", ""),
        ("Istwert [mm]", "position", ""),
        ("Glasmaßstab [Ink]", "load", ""),
        ("ROBOT_ACTUAL_JOINT_POSITIONS (J3)", "position", "robot_j_3"),
        ("Z1_OutputPower", None, ""),
        ("actual_TCP_pose_0", None, ""),
        ("actual_execution_time", None, ""),
        ("joint_control_output_0", "command", "0"),
        ("joint_temperatures_0", "temperature", "0"),
        ("cart_position_m", "position", "cart"),
        ("q_m", "position", ""),
        ("EPOSPosition ()", "position", "epos"),
        ("qDDot", None, ""),
        ("wheel1_rad/s", "velocity", "wheel_1"),
        ("target1_rad/s", "asked speed", "1"),
        ("motor_inc_position", "position", ""),
        ("Gravity Torque [Nm]", "effort", ""),
        ("ql", "load", ""),
        ("PosSet_mm", "reference", ""),
        ("gyro_deg_s", "velocity", ""),
        ("left_ticks", "position", "left"),
        ("tracker_x_m", "load", "x"),
        ("gt_x", "load", "x"),
        ("theta_dot", "velocity", ""),
        ("theta_ddot_kalman", None, ""),
        ("input", "command", ""),
        ("leftSpeedRpm", "velocity", "left"),
        ("rpm", "velocity", ""),
        ("deg", "position", ""),
        ("Velocidad (rad/s)", "velocity", ""),
        ("wheel 1 [rpm]", "velocity", "wheel_1"),
        ("Rspeed", "velocity", "r"),
        ("Motorspannung", "command", ""),
        ("jointangle", "position", ""),
        ("positionerror", None, ""),
        ("LControl", "command", "l"),
        ("reset", None, ""),
        ("targetSpeed", "asked speed", ""),
        ("Z_RIst", "position", "z"),
        ("pidOutput", "command", ""),
        ("a_x", None, ""),
        ("velo", "velocity", ""),
        ("motorRPM_2", "velocity", "2"),
        ("rpm_value", "velocity", ""),
        ("Rev", "position", ""),
        ("motor_roll_erpm", "velocity", "roll"),
        ("ff_roll_erpm", None, ""),
        ("batt_voltage", None, ""),
        ("Air_speed", None, ""),
        ("motor_spd", "velocity", ""),
        ("position_reelle_FL_HAA", "position", "fl_haa"),
        ("obs_13: joint_pos_FL_HAA", "position", "fl_haa"),
    ],
)
def test_a_name_says_signal_and_axis(column, signal, axis):
    found = parse(column)
    assert found.signal == signal and (signal is None or found.axis == axis)


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        ("q [°]", "deg"),
        ("Torque (%)", "%"),
        ("i_mA", "mA"),
        ("tau (Nm)", "N*m"),
        ("velocity measured [Hz]", "rev/s"),
        ("q_1", None),
        ("x (inch)", "inch"),
        ("M_Nmm", "mN*m"),
        ("force_N", "N"),
        ("reading_N", "N"),
        ("thrust_N", "N"),
        ("joint_N", None),
        ("cycle_N", None),
        ("q_N", None),
        ("q_A", None),
        ("dist_m", "m"),
        ("gyro_deg_s", "deg/s"),
        ("time_s", "s"),
        ("joint_s", None),
        ("FORCE (x)", None),
        ("wheelSpeedRpm", "rpm"),
        ("Motor Optical Speed (RPM)", "rpm"),
        ("speed [r/min]", "rpm"),
        ("cmd_erpm", "rpm"),
        ("timeMs", "ms"),
        ("positionMin", None),
    ],
)
def test_a_unit_stands_in_brackets_or_at_the_end(column, unit):
    assert bare_and_unit(column)[1] == unit


def test_names_of_time():
    assert all(
        tells_time(x) for x in ("t", "Time (ms)", "__time", "t_ns", "header.stamp", "Zeit [s]", "ms", "seconds", "i_ms")
    )
    assert not any(tells_time(x) for x in ("q", "torque", "state", "servo_us", "pwm [us]"))


def test_signals_without_an_axis_of_their_own_belong_to_the_only_one():
    placed = {("q", None): ("position", ""), ("drive/torque", None): ("effort", "drive")}
    groups, left = together(placed)
    assert groups == {"": {"position": ("q", None), "effort": ("drive/torque", None)}} and not left


def test_signals_of_several_axes_find_theirs_by_number():
    placed = {("q1", None): ("position", "1"), ("q2", None): ("position", "2"), ("tau_J2", None): ("effort", "J_2")}
    placed[("tau", None)] = ("effort", "")
    groups, left = together(placed)
    assert groups["2"]["effort"] == ("tau_J2", None) and "effort" not in groups["1"] and left == ["tau"]


def test_a_unit_may_stand_behind_a_blank():
    assert (parse("Target um").signal, parse("Target um").unit) == ("reference", "um")
    assert parse("T Nut").unit is None and parse("Motor A").unit is None


def test_what_points_somewhere_is_a_position():
    assert (parse("az_rad").signal, parse("az_cmd_rad").signal) == ("position", "reference")
    assert parse("az_rad").axis == parse("az_cmd_rad").axis == "az"
