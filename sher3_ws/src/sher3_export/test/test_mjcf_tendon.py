"""Motors that move several joints, read back by MuJoCo: a fixed tendon is as long as a motor's travel."""

import mujoco
import numpy as np
import pytest
from sher3_chain.manipulator.description import BEHIND
from sher3_export import ExportError, export
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

MODEL = """<mujoco><option timestep="0.001" gravity="0 0 0" integrator="implicit"/><worldbody>
  <body><joint name="elbow" axis="0 1 0"/><inertial pos="0 0 .1" mass="1" diaginertia=".1 .1 .1"/>
    <body pos="0 0 .2"><joint name="wrist" axis="0 1 0"/><inertial pos="0 0 .1" mass="1" diaginertia=".1 .1 .1"/></body>
  </body></worldbody></mujoco>"""
TRAVEL = {"wrist": {"elbow": 0.5, "wrist": 2.0}}
SHARES = np.array([0.5, 2.0])


def written(*causes, motors=TRAVEL):
    return export(verdict(*causes), "mjcf", parse_xml(MODEL, "mujoco"), motors=motors)


def test_friction_and_rotor_of_a_motor_act_by_its_own_travel():
    """Damping c of the motor is c times the outer product of its shares at the joints, and so is the rotor."""
    friction, damping = cause("coulomb_friction", "wrist", force=0.3), cause("viscous_friction", "wrist", extra=0.7)
    rotor = cause("rotor_inertia", "wrist", unit="kg*m^2", inertia=0.02)
    done = written(friction, damping, rotor)
    model, bare = mujoco.MjModel.from_xml_string(done.text), mujoco.MjModel.from_xml_string(MODEL)
    assert len(done.applied) == 3 and model.ntendon == 1 and model.tendon_frictionloss[0] == pytest.approx(0.3)
    assert not model.dof_damping.any() and not model.dof_frictionloss.any()
    found, without = mujoco.MjData(model), mujoco.MjData(bare)
    found.qvel[:] = without.qvel[:] = (0.4, -0.3)
    mujoco.mj_forward(model, found)
    mujoco.mj_forward(bare, without)
    assert found.ten_velocity[0] == pytest.approx(SHARES @ found.qvel)
    assert found.qfrc_passive == pytest.approx(-0.7 * SHARES * (SHARES @ found.qvel))
    full, own = np.zeros((2, 2)), np.zeros((2, 2))
    mujoco.mj_fullM(model, found, full)
    mujoco.mj_fullM(bare, without, own)
    assert full - own == pytest.approx(0.02 * np.outer(SHARES, SHARES))


def test_what_a_tendon_has_no_field_for_is_listed():
    done = written(cause("backlash", "wrist", unit="rad", width=0.01))
    assert not done.applied and "tendon has frictionloss, damping, armature alone" in str(done.not_expressed[0])
    done = written(cause("coulomb_friction", "wrist", force=0.3), motors={"wrist": {"hand": 1.0}})
    assert "no joint hand (joints: elbow, wrist)" in str(done.not_expressed[0])


def test_other_targets_say_which_has_a_field():
    friction = verdict(cause("coulomb_friction", "wrist", force=0.3))
    assert len(export(friction, "yaml", motors=TRAVEL).applied) == 1
    done = export(friction, "ros2_control", motors=TRAVEL)
    assert "ros2_control has no field for a motor that moves several joints; --to mjcf has" in str(
        done.not_expressed[0]
    )


def test_causes_behind_a_coupling_are_not_written_at_the_joints_instead():
    behind = verdict(cause("coulomb_friction", "wrist", force=0.3)).model_copy(update={"notes": [f"{BEHIND}forces"]})
    with pytest.raises(ExportError, match="no --motor") as refused:
        export(behind, "mjcf", parse_xml(MODEL, "mujoco"))
    assert "--motor wrist=" in str(refused.value)
