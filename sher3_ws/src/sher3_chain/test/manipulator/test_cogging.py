"""A cogging on a joint of a drawn arm whose gear nobody states: told, written into the model, and gone."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, asked, drawn_xml, served
from sher3_chain.readings.orders import orders_in

SECONDS, SHOULDER, PHASE = 8.0, 1, 0.7


def test_orders_of_two_waves_beside_a_spring_and_friction():
    """Ten turns back and forth over 2 rad; 31.4 and 12.5 periods per turn are ten and four over the travel."""
    q = np.sin(np.linspace(0.0, 40.0 * np.pi, 20_000))
    speed = np.gradient(q)
    force = 0.5 * np.sin(31.4 * q) + 0.2 * np.sin(12.5 * q + 1.0) + 3.0 * q + np.sign(speed)
    found = orders_in(force, q, speed, 2)
    assert found == pytest.approx([31.4, 12.5], abs=1.0)


def test_orders_of_an_axis_that_mostly_rests_are_few():
    """Its middle speed is a rounding error: orders without end would fit into the bandwidth."""
    q = np.r_[np.zeros(2000), np.sin(np.linspace(0.0, 20.0, 900))]
    speed = np.gradient(q) + 1e-18
    assert len(orders_in(np.sin(9.0 * q), q, speed, 2)) == 2


@pytest.mark.parametrize(("seed", "periods"), [(2102, 12.0), (2104, 31.5)])
def test_a_cogging_is_told_and_its_correction_moves_as_the_arm(seed, periods):
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=3)
    model = mujoco.MjModel.from_xml_string(xml)
    stamps = np.arange(round(SECONDS / model.opt.timestep)) * model.opt.timestep
    ctrl = asked(rng, stamps, model.nu) * model.actuator_gear[:, 0]
    qpos, force = served(model, ctrl, SHOULDER, 0, lambda d: -0.3 * np.sin(periods * d.qpos[SHOULDER] + PHASE))
    log = {"time": stamps, "ctrl": ctrl, "qpos": qpos + NOISE * rng.standard_normal(qpos.shape)}
    answer = gap.diagnose(xml, {**log, "actuator_force": force})
    (cause,) = answer.causes
    assert (cause.effect, cause.actuator) == ("cogging", "shoulder")
    told = {name: p.value for name, p in cause.parameters.items()}
    assert told["amplitude"] == pytest.approx(0.3, rel=0.02)
    assert told["periods_per_turn"] == pytest.approx(periods, rel=0.002)
    assert told["phase"] == pytest.approx(PHASE, abs=0.03)
    corrected = mujoco.MjModel.from_xml_string(answer.corrected().text)
    assert corrected.nu == model.nu
    off = [np.sqrt(np.mean((served(m, ctrl)[0] - qpos) ** 2)) for m in (model, corrected)]
    assert off[1] < 0.05 * off[0]
    again = gap.diagnose(answer.corrected().text, {**log, "actuator_force": force})
    assert again.status == "no_gap"
