"""A wave between two encoders of an axis whose lead nobody stated: its period is found."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine


def slits(seed, amplitude=None):
    """A blade on a stepper and its resolver: travel, speed, period and phase are drawn; one way, or there and back."""
    draw = np.random.default_rng(seed)
    stroke, seconds, phase = draw.uniform(5e-3, 0.2), draw.uniform(20.0, 60.0), draw.uniform(0.0, 6.0)
    period, size = stroke / draw.uniform(8.0, 40.0), draw.uniform(5e-6, 30e-6) if amplitude is None else amplitude
    t = np.arange(0.0, seconds, 0.01)
    way = np.interp(t, [0.0, seconds / 2, seconds], [0.0, stroke, draw.choice([0.0, 2.0]) * stroke])
    load = way + size * np.sin(2 * np.pi * way / period + phase) + 0.3e-6 * draw.normal(size=len(t)) + 1e-4
    return size, period, AxesRun("run", 0.01, {"slide": {"position": way, "load": load}})


def verdict_of(run):
    known = {"mass": None, "command_law": {"kind": "none"}, "encoder_resolution": 5e-7}
    return diagnose(machine(signals=columns("position", "load"), **known), [run]).verdict


@pytest.mark.parametrize("seed", range(6))
def test_amplitude_and_period_are_told(seed):
    size, period, run = slits(seed)
    (cause,) = verdict_of(run).causes
    assert cause.effect == "transmission_ripple"
    assert cause.parameters["amplitude"].value == pytest.approx(size, rel=0.03)
    assert cause.parameters["period"].value == pytest.approx(period, rel=0.01)


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_has_no_period(seed):
    assert not verdict_of(slits(seed, amplitude=0.0)[2]).causes
