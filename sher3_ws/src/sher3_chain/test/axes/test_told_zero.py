"""A drive that was told nothing for a while gave nothing: a mass on a spring swings under it, and tells the spring."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.level import off
from sher3_diagnosis import diagnose
from slides import columns, machine

COUNT = 1e-3


def rung(seed):
    """A mass on a drawn spring under a voltage that goes on and off, as a teaching rig is tested; and its truth."""
    draw = np.random.default_rng(seed)
    period, fine = draw.uniform(0.004, 0.009), 20
    stiffness, damping, gain = draw.uniform(300.0, 900.0), draw.uniform(4.0, 8.0), draw.uniform(100.0, 300.0)
    steps = np.cumsum(draw.uniform(1.5, 2.5, 4))
    t = np.arange(0.0, steps[-1], period)
    told = np.where(np.searchsorted(steps, t) % 2 == 0, draw.uniform(0.5, 1.0), 0.0)
    x = v = 0.0
    places = []
    for u in told.tolist():
        places.append(x)
        for _ in range(fine):
            v += period / fine * (gain * u - stiffness * x - damping * v)
            x += period / fine * v
    position = COUNT * np.round(np.array(places) / COUNT)
    return AxesRun("run", period, {"slide": {"position": position, "effort": told}}), stiffness / gain, damping / gain


@pytest.mark.parametrize("seed", range(2))
def test_zero_is_a_force_where_a_drive_is_told_steps(seed):
    run, stiffness, _ = rung(seed)
    signals = {"position": {"column": "q", "unit": "m"}, **columns("effort", unit="V")}
    rig = machine(signals=signals, mass="unknown", command_law={"kind": "force"}, encoder_resolution=COUNT)
    verdict = diagnose(rig, [run]).verdict
    (spring,) = (c for c in verdict.causes if c.effect == "spring_torque")
    assert spring.parameters["stiffness"].value == pytest.approx(stiffness, rel=0.1)
    assert not any("the drive is off" in n for n in verdict.notes)


def test_a_measured_current_that_is_exactly_nothing_is_a_drive_that_is_off():
    measured = np.sin(np.arange(1000) / 30.0)
    measured[400:600] = 0.0
    assert off(measured).sum() == 200 and not off(np.sign(measured)).any()
