"""An effort that the drive filtered before it was recorded; friction that turns between two samples."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

FINE = np.arange(0.0, 20.0, 2e-4)
COUNT = 2.0 * np.pi / 65536


def verdict_of(rate, order, inertia=0.02, corner=16.7, mass=None):
    """A joint that swings at 1.7 Hz with 1.0 N m of dry and 0.05 N m/(rad/s) of viscous friction."""
    q = 0.5 * np.sin(2.0 * np.pi * 1.7 * FINE) + 0.1 * np.sin(np.pi * FINE)
    v = np.gradient(q, FINE)
    effort = inertia * np.gradient(v, FINE) + np.tanh(v / 0.01) + 0.05 * v
    if order == 1:
        share = 1.0 - np.exp(-2.0 * np.pi * corner * 2e-4)
        effort = lfilter([share], [1.0, share - 1.0], effort)
    elif order == 2:
        effort = lfilter(*butter(2, corner * 4e-4), effort)
    every = round(5000 / rate)
    q, effort = q[::every], effort[::every]
    effort = effort + 0.01 * np.random.default_rng(3).normal(size=len(effort))
    run = AxesRun("run", 1.0 / rate, {"slide": {"position": COUNT * np.round(q / COUNT), "effort": effort}})
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    law = {"motion": "rotary", "mass": mass or inertia, "command_law": {"kind": "force"}, "encoder_resolution": COUNT}
    return diagnose(machine(signals=signals, **law), [run]).verdict


def dry(verdict):
    return next(c.parameters["force"] for c in verdict.causes if "force" in c.parameters and c.family == "friction")


@pytest.mark.parametrize(("rate", "order"), [(100, 0), (100, 1), (100, 2), (500, 0), (500, 1), (500, 2)])
def test_dry_friction_is_right_behind_a_filter_of_17_hz(rate, order):
    """The published miss: 0.58 (0.53 .. 0.64) for 1.0."""
    verdict = verdict_of(rate, order)
    force = dry(verdict)
    assert force.value == pytest.approx(1.0, rel=0.03) and force.low - 0.005 <= 1.0 <= force.high + 0.005
    viscous = next(c.parameters["extra"] for c in verdict.causes if c.effect == "viscous_friction")
    assert viscous.value == pytest.approx(0.05, abs=0.006)
    told = [n for n in verdict.notes if "low-passed before it was recorded" in n]
    assert bool(told) == bool(order)


def test_a_viscous_friction_under_the_noise_widens_the_interval_of_the_dry_one():
    """0.2 kg m^2 under the encoder's noise: the dry friction takes the viscous one up, and its interval says so."""
    verdict = verdict_of(100, 1, inertia=0.2)
    force = dry(verdict)
    assert force.low <= 1.0 <= force.high
