"""Servos and passive motors in a MuJoCo model: read back by MuJoCo, and by how the model then moves."""

import mujoco
import numpy as np
import pytest
from sher3_diagnosis.verdict import Parameter
from sher3_export import export
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

MODEL = """<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body name="b">
<joint name="slide" type="hinge" axis="0 0 1" frictionloss="1"/>
<inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody>
<actuator><position name="p" joint="slide" kp="200" kv="10"/></actuator></mujoco>"""
STRIBECK = cause("stribeck_friction", force=2.0, static=5.0, stribeck_velocity=0.1)


def written(*causes):
    done = export(verdict(*causes), "mjcf", parse_xml(MODEL, "mujoco"))
    return done, mujoco.MjModel.from_xml_string(done.text)


def given(model, q, v):
    """Force of all actuators on the joint, its servo at rest, N m."""
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0], data.ctrl[0] = q, v, q
    mujoco.mj_forward(model, data)
    return float(data.qfrc_actuator[0]) + 10.0 * v


def test_a_cogging_takes_no_control_and_is_the_force_that_the_drive_then_needs():
    done, model = written(cause("cogging", amplitude=0.5, periods_per_turn=12.0, phase=0.3))
    assert not done.not_expressed and model.nu == 1
    for q in (0.0, 0.1, 0.37):
        assert given(model, q, 0.0) == pytest.approx(-0.5 * np.sin(12.0 * q + 0.3))


@pytest.mark.parametrize("unit", ["N*m", "rad"])
def test_a_weight_at_an_arm_is_a_cogging_of_one_period(unit):
    """Against the drive a sin(q - hanging), whatever hangs on the joint; of a servo without forces times its kp."""
    hanging = Parameter(value=0.4, low=0.3, high=0.5, unit="rad")
    done, model = written(cause("gravity_load", unit=unit, arm=0.5, hanging=hanging))
    assert not done.not_expressed and model.nu == 1
    for q in (0.0, 0.4, 1.7):
        assert given(model, q, 0.0) == pytest.approx(
            -0.5 * (200.0 if unit == "rad" else 1.0) * np.sin(q - 0.4), abs=1e-6
        )


def test_friction_at_rest_moves_with_that_in_motion_into_lugre_s_law():
    done, model = written(STRIBECK)
    assert not done.not_expressed and model.nu == 1 and model.dof_frictionloss[0] == pytest.approx(1.0)
    data, broke = mujoco.MjData(model), 0.0
    for k in range(8000):
        data.ctrl[0] = data.qpos[0] + 10.0 * data.qvel[0] / 200.0  # the servo gives nothing
        data.qfrc_applied[0] = k * 1e-3
        mujoco.mj_step(model, data)
        if data.qvel[0] > 0.02:
            broke = float(data.qfrc_applied[0])
            break
    assert broke == pytest.approx(1.0 + 5.0, abs=0.2)
    data.qvel[0] = 1.0
    for _ in range(200):
        data.ctrl[0] = data.qpos[0] + 10.0 * data.qvel[0] / 200.0
        data.qfrc_applied[0] = 3.0
        mujoco.mj_step(model, data)
    assert float(data.qfrc_actuator[0]) == pytest.approx(-2.0, abs=0.05)


def light(inertia, step):
    """The model with a small joint without a drive, and another step."""
    still = MODEL.replace('<position name="p" joint="slide" kp="200" kv="10"/>', "")
    still = still.replace("0.001", str(step)).replace('frictionloss="1"', "")
    own = f'mass="0.1" diaginertia="{inertia} {inertia} {inertia}"'
    return parse_xml(still.replace('mass="2" diaginertia="1 1 1"', own), "mujoco")


@pytest.mark.parametrize(("inertia", "step"), [(5e-3, 0.002), (5e-4, 0.0005), (1.0, 0.002)])
def test_the_bristle_of_a_small_joint_is_as_soft_as_its_step_needs(inertia, step):
    """A push below the friction at rest leaves the joint where it is."""
    done = export(verdict(STRIBECK), "mjcf", light(inertia, step))
    assert not done.not_expressed
    model = mujoco.MjModel.from_xml_string(done.text)
    data = mujoco.MjData(model)
    speeds = []
    for k in range(4000):
        data.qfrc_applied[0] = min(3.0, k / 500.0)
        mujoco.mj_step(model, data)
        speeds.append(abs(float(data.qvel[0])))
    assert data.qpos[0] < 0.03 and max(speeds[2000:]) < 1e-3


def test_a_joint_too_light_for_its_step_is_refused_with_the_step_it_needs():
    (left,) = {
        x.reason for x in export(verdict(STRIBECK), "mjcf", light(1e-4, 0.002)).not_expressed if x.constant == "static"
    }
    assert "a timestep of 0.00032 s can express it" in left


def test_gains_and_the_reference_of_a_servo():
    done, model = written(
        cause("controller_gain", relative=-0.1, unit="1"), cause("command_delay", reference_delay=0.024, unit="s")
    )
    assert not done.not_expressed
    assert model.actuator_gainprm[0][0] == pytest.approx(180.0) and model.actuator_biasprm[0][2] == pytest.approx(-9.0)
    assert model.actuator_delay[0] == pytest.approx(0.024)
    _, model = written(cause("controller_gain", velocity_relative=0.5, unit="1"))
    assert model.actuator_gainprm[0][0] == pytest.approx(200.0) and model.actuator_biasprm[0][2] == pytest.approx(-15.0)


def test_a_motor_has_no_gains_of_a_servo():
    model = MODEL.replace('<position name="p" joint="slide" kp="200" kv="10"/>', '<motor joint="slide"/>')
    done = export(verdict(cause("controller_gain", relative=-0.1)), "mjcf", parse_xml(model, "mujoco"))
    assert not done.applied and "no such actuator" in done.not_expressed[0].reason
