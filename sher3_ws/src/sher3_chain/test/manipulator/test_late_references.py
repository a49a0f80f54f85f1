"""A servo of a drawn arm whose reference acts 20 ms late, in motion up to 4 Hz: the delay alone, at its size."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, asked, drawn_xml, served

SECONDS, LATE, FASTER = 8.0, 0.02, 4.0


@pytest.mark.parametrize("seed", [3302, 3303, 3305])
def test_a_late_reference_in_fast_motion_is_a_delay_and_no_gain(seed):
    """Two terms of the delay's series told 19.4 ms, or a gain of -17 % beside 22.3 ms, of these arms."""
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=3)
    model = mujoco.MjModel.from_xml_string(xml)
    stamps = np.arange(round(SECONDS / model.opt.timestep)) * model.opt.timestep
    place = int(rng.integers(3))
    ctrl = 0.4 * asked(rng, FASTER * stamps, model.nu) * model.actuator_gear[:, 0]
    qpos, force = served(model, ctrl, place, round(LATE / model.opt.timestep))
    log = {"time": stamps, "ctrl": ctrl, "qpos": qpos + NOISE * rng.standard_normal(qpos.shape)}
    answer = gap.diagnose(xml, {**log, "actuator_force": force})
    (cause,) = answer.causes
    assert cause.effect == "command_delay"
    assert cause.parameters["reference_delay"].value == pytest.approx(LATE, rel=0.01)
    delayed = xml.replace("<position ", f'<position delay="{LATE}" nsample="32" ', place + 1)
    delayed = delayed.replace(f'<position delay="{LATE}" nsample="32" ', "<position ", place)
    told = gap.diagnose(delayed, {**log, "actuator_force": force})
    assert not told.causes and any("its control acts 20 ms late, as the model says" in x for x in told.guessed)
