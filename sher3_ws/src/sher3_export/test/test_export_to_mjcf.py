"""Each constant in a MuJoCo model, read back by MuJoCo itself and by how the model then moves."""

import math

import mujoco
import numpy as np
import pytest
from sher3_export import ExportError, export
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

MODEL = """<mujoco>
  <!-- a comment of the user's -->
  <compiler angle="radian"/>
  <option timestep="0.001" gravity="0 0 0"/>
  <default><default class="d"><joint damping="3" frictionloss="1"/><position kp="200"/></default></default>
  <worldbody><body name="b" childclass="d"><joint name="slide" type="slide" axis="1 0 0"/>
    <inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/></body></worldbody>
  <actuator><motor name="m" joint="slide"/></actuator>
</mujoco>"""


def written(*causes, model=MODEL, joints=None):
    done = export(verdict(*causes), "mjcf", parse_xml(model, "mujoco"), joints)
    return done, mujoco.MjModel.from_xml_string(done.text)


def test_friction_and_damping_add_to_what_default_classes_say():
    done, model = written(cause("coulomb_friction", force=8.0), cause("viscous_friction", extra=40.0))
    assert model.dof_frictionloss[0] == pytest.approx(9.0)
    assert model.dof_damping[0] == pytest.approx(43.0)
    assert len(done.applied) == 2 and not done.not_expressed
    assert "a comment of the user's" in done.text and "coulomb_friction on slide" in done.text


def test_what_mujoco_cannot_express_is_listed_and_stands_in_the_file():
    done, model = written(
        cause("coulomb_friction", force=4.0), cause("gear_loss", share=0.1), cause("transmission_ripple", amplitude=1.0)
    )
    assert model.dof_frictionloss[0] == pytest.approx(5.0)
    assert {(x.effect, x.constant) for x in done.not_expressed} == {
        ("gear_loss", "load_loss"),
        ("transmission_ripple", ""),
    }
    assert all(str(x).replace("--", "- -") in done.text for x in done.not_expressed)


def moved(model, control, seconds):
    data = mujoco.MjData(model)
    out = []
    for _ in range(round(seconds / model.opt.timestep)):
        data.ctrl[0] = control
        mujoco.mj_step(model, data)
        out.append(data.qpos.copy())
    return np.array(out)


def test_a_delay_a_gain_a_limit_and_an_offset_act_on_the_motion():
    plain = MODEL.replace('damping="3" frictionloss="1"', "")
    _, model = written(cause("command_delay", delay=0.05, unit="s"), model=plain)
    q = moved(model, 4.0, 0.2)[:, 0]
    assert np.argmax(q > 0.0) == pytest.approx(51, abs=1)
    _, model = written(cause("torque_constant", relative=0.5, unit="1"), model=plain)
    assert moved(model, 4.0, 0.1)[-1, 0] == pytest.approx(0.5 * 3.0 * 0.01, rel=0.02)
    _, model = written(cause("force_saturation", limit=1.0), model=plain)
    assert moved(model, 4.0, 0.1)[-1, 0] == pytest.approx(0.5 * 0.5 * 0.01, rel=0.02)
    _, model = written(cause("gravity_load", force=2.0), model=plain)
    assert moved(model, 4.0, 0.1)[-1, 0] == pytest.approx(0.5 * 1.0 * 0.01, rel=0.02)
    _, model = written(cause("payload_mass", mass=2.0, unit="kg"), model=plain)
    assert moved(model, 4.0, 0.1)[-1, 0] == pytest.approx(0.5 * 1.0 * 0.01, rel=0.02)


def test_a_gap_is_a_second_joint_that_the_motor_crosses_alone():
    plain = MODEL.replace('damping="3" frictionloss="1"', "")
    _, model = written(cause("backlash", width=0.01, unit="m"), model=plain)
    assert model.njnt == 2 and model.jnt_range[1] == pytest.approx([-0.005, 0.005])
    q = moved(model, 0.01, 0.05)
    assert q[-1, 0] > 0.004  # the motor is through the gap
    assert abs(q[-1].sum()) < 0.001  # the load has hardly moved


def test_a_spring_gives_way_by_its_compliance():
    plain = MODEL.replace('damping="3" frictionloss="1"', "")
    _, model = written(cause("transmission_compliance", compliance=1e-3, stiffness=1e3, unit="m/N"), model=plain)
    assert float(np.ravel(model.jnt_stiffness[1])[0]) == pytest.approx(1e3)
    assert moved(model, 2.0, 0.1)[-1, 1] == pytest.approx(-2.0 * 1e-3, rel=0.1)


def test_a_servos_forces_are_scaled_by_its_stiffness():
    model = MODEL.replace('<motor name="m" joint="slide"/>', '<position name="m" joint="slide" class="d"/>')
    done, compiled = written(cause("coulomb_friction", force=0.01, unit="m"), model=model)
    assert compiled.dof_frictionloss[0] == pytest.approx(1.0 + 0.01 * 200.0)
    done, _ = written(cause("coulomb_friction", force=0.01, unit="m"))
    assert "stiffness" in done.not_expressed[0].reason


def test_an_offset_of_the_zero_shifts_the_reading():
    model = MODEL.replace('type="slide" axis="1 0 0"', 'type="hinge" axis="0 0 1"')
    _, compiled = written(cause("encoder_offset", offset=0.1, unit="rad"), model=model)
    assert compiled.qpos0[0] == pytest.approx(0.1)
    _, compiled = written(
        cause("encoder_offset", offset=0.1, unit="rad"), model=model.replace('<compiler angle="radian"/>', "")
    )
    assert compiled.qpos0[0] == pytest.approx(0.1) and math.degrees(0.1) != 0.1


def test_a_spring_beside_the_joint_and_a_payload_on_its_link():
    done, model = written(
        cause("spring_torque", stiffness=50.0, rest=0.2, unit="N/m"),
        cause("payload_mass", "b", mass=0.5, x=0.1, y=0.0, z=-0.2, unit="kg"),
    )
    assert not done.not_expressed and sum(model.body_mass) == pytest.approx(2.5)
    assert float(np.ravel(model.jnt_stiffness[0])[0]) == pytest.approx(50.0)
    assert model.qpos_spring[0] == pytest.approx(0.2)
    assert model.body("b_payload").pos == pytest.approx([0.1, 0.0, -0.2])


def test_another_name_of_the_joint_is_given_or_the_cause_is_listed():
    done, model = written(cause("coulomb_friction", "axis_1", force=8.0), joints={"axis_1": "slide"})
    assert model.dof_frictionloss[0] == pytest.approx(9.0)
    done, model = written(cause("coulomb_friction", "axis_1", force=8.0))
    assert "slide" in done.not_expressed[0].reason and model.dof_frictionloss[0] == 1.0


@pytest.mark.parametrize("text", ["<!DOCTYPE a><mujoco/>", "<mujoco", "<robot/>", "\0"])
def test_what_is_no_model_is_refused(text):
    with pytest.raises(ExportError):
        parse_xml(text, "mujoco")


def test_a_model_without_joints_is_refused():
    with pytest.raises(ExportError, match="no joint"):
        export(verdict(cause("coulomb_friction", force=8.0)), "mjcf", parse_xml("<mujoco/>", "mujoco"))


def twice(one, other):
    """Return the model with a cause, and with a second one of the kind in the model that was made so."""
    done, first = written(one)
    _, second = written(other, model=done.text)
    return first, second


def test_a_second_export_changes_what_the_first_one_wrote_and_adds_no_second():
    """A corrected model is diagnosed again, and what is left is written into it."""
    first, second = twice(cause("gravity_load", force=2.0), cause("gravity_load", force=0.5))
    assert (first.nu, second.nu) == (2, 2) and second.actuator_biasprm[1, 0] == pytest.approx(-2.5)
    first, second = twice(cause("backlash", width=0.01), cause("backlash", width=0.004))
    assert first.njnt == second.njnt == 2 and second.jnt_range[1] == pytest.approx([-0.007, 0.007])
    springs = [cause("transmission_compliance", compliance=c) for c in (1e-4, 3e-4)]
    first, second = twice(*springs)
    assert first.njnt == second.njnt == 2 and second.jnt_stiffness[1] == pytest.approx(2500.0)
    first, second = twice(cause("drive_lag", time_constant=0.1), cause("drive_lag", time_constant=0.02))
    assert (first.na, second.na) == (1, 1) and second.actuator_dynprm[0, 0] == pytest.approx(0.12)


def test_a_second_payload_has_a_place_of_its_own():
    loads = [cause("payload_mass", "b", mass=m, x=x, y=0.0, z=0.0) for m, x in ((1.0, 0.1), (0.5, -0.2))]
    _, model = twice(*loads)
    names = ("b_payload", "b_payload_2")
    assert [model.body(n).mass[0] for n in names] == [1.0, 0.5]
    assert [model.body(n).pos[0] for n in names] == pytest.approx([0.1, -0.2])
