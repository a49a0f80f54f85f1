"""A link that is heavier or lighter than its model says, on a lift with a pendulum and on drawn arms of MuJoCo."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, drawn_xml, log_of_servos
from lifts import MJCF, friction, machine, motion, needed, run_of, values
from sher3_diagnosis import diagnose

Q, V, A = motion()
SECONDS = 8.0


@pytest.mark.parametrize("times", [2.0, 0.5])
def test_a_pendulum_of_another_mass_than_the_model_says(tmp_path, times):
    """The efforts are those of 2 kg; the model says `times` as much, inertia included."""
    inertia = 0.01 * times
    stated = f'mass="{2.0 * times}" diaginertia="{inertia} {inertia} {inertia}"'
    text = MJCF.replace('mass="2.0" diaginertia="0.01 0.01 0.01"', stated)
    arm = machine(tmp_path / "lift.xml", text=text)
    found = diagnose(arm, [run_of(Q, needed(Q, V, A) + friction(V, (8.0, 0.5)))]).verdict
    assert {(c.effect, c.actuator) for c in found.causes} == {
        ("link_mass", "pendulum"),
        ("coulomb_friction", "lift"),
        ("coulomb_friction", "swing"),
    }
    assert values(found)["link_mass", "pendulum", "relative"] == pytest.approx(1.0 / times - 1.0, rel=0.02)


@pytest.mark.parametrize(("seed", "share"), [(2005, 0.6), (2007, -0.5)])
def test_a_link_of_a_drawn_arm_is_told_written_into_its_model_and_gone(seed, share):
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=3)
    spec = mujoco.MjSpec.from_string(xml)
    spec.bodies[3].geoms[0].mass *= 1.0 + share
    real = spec.compile()
    answer = gap.diagnose(xml, log_of_servos(real, rng, SECONDS))
    assert [(c.effect, c.actuator) for c in answer.causes] == [("link_mass", "body3")]
    relative = answer.causes[0].parameters["relative"]
    assert relative.value == pytest.approx(share, abs=0.02) and relative.low <= share <= relative.high
    corrected = mujoco.MjModel.from_xml_string(answer.corrected().text)
    assert corrected.body_mass == pytest.approx(real.body_mass, rel=0.02)
    assert corrected.body_inertia == pytest.approx(real.body_inertia, rel=0.02)


def test_a_slide_without_weight_is_too_heavy_in_the_model():
    """The published example of mujoco.sysid: a slide on a spring, given with twice its mass."""
    xml = (
        '<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody><body name="car">'
        '<joint name="slide" type="slide" axis="1 0 0" stiffness="30" damping="0.5"/>'
        '<geom type="box" size=".1 .1 .1" mass="{mass}"/></body></worldbody>'
        '<actuator><motor name="push" joint="slide"/></actuator></mujoco>'
    )
    real = mujoco.MjModel.from_xml_string(xml.format(mass=1.0))
    data, rows = mujoco.MjData(real), []
    for i in range(5000):
        data.ctrl[0] = 3.0 * np.sin(2.0 * data.time) + 2.0 * np.sin(7.0 * data.time + i // 1250)
        mujoco.mj_forward(real, data)
        rows.append([data.time, data.ctrl[0], data.qpos[0]])
        mujoco.mj_step(real, data)
    time, ctrl, qpos = np.array(rows).T
    answer = gap.diagnose(xml.format(mass=2.0), time, ctrl, qpos + NOISE * np.random.default_rng(0).normal(size=5000))
    assert (answer.causes[0].effect, answer.causes[0].actuator) == ("link_mass", "car")
    assert answer.causes[0].parameters["relative"].value == pytest.approx(-0.5, abs=0.01)


@pytest.mark.parametrize(("seed", "times"), [(2005, 30.0), (2011, 60.0)])
def test_a_rotor_is_no_link_many_times_as_heavy_as_the_arm(seed, times):
    """The first joint turns about the vertical: a rotor and a heavier first link need the same force of it alone."""
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=3)
    spec = mujoco.MjSpec.from_string(xml)
    nominal = spec.compile()
    spec.joints[0].armature = nominal.dof_armature[0] + times * nominal.body_inertia[1].max()
    answer = gap.diagnose(xml, log_of_servos(spec.compile(), rng, SECONDS))
    assert "rotor_inertia" in {c.effect for c in answer.causes if c.actuator == "turn"}
    assert not {c.effect for c in answer.causes} & {"link_mass", "payload_mass"}
