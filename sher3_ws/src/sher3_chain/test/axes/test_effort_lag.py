"""A force that follows the recorded effort late: a propeller behind a voltage, a chamber behind a valve."""

import numpy as np
import pytest
from scipy.signal import lfilter
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

FINE = 1e-3


def swung(lag=0.0, delay=0.0, seed=0, rate=100, viscous=0.05, dry=0.05, weight=1.5, mass=0.02, mass_known=None):
    """An arm that hangs in bearings and is lifted by a force that comes late; steps of a random size drive it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 40.0, FINE)
    asked = np.repeat(rng.uniform(-1.2, 1.2, 80), 500)
    acts = np.interp(t - delay, t, asked)
    if lag:
        share = 1.0 - np.exp(-FINE / lag)
        acts = lfilter([share], [1.0, share - 1.0], acts)
    q, v, place = 0.0, 0.0, np.empty(len(t))
    for k, force in enumerate(acts):
        place[k] = q
        free = v + FINE / mass * (force - weight * np.sin(q) - viscous * v)
        v = free - np.clip(free, -FINE / mass * dry, FINE / mass * dry)
        q += FINE * v
    every = 1000 // rate
    count = 2.0 * np.pi / 4096
    position = count * np.round(place[::every] / count)
    effort = asked[::every] + 0.005 * rng.normal(size=len(position))
    run = AxesRun("run", 1.0 / rate, {"slide": {"position": position, "effort": effort}})
    signals = {**columns("position", unit="rad"), **columns("effort", unit="V")}
    law = {"motion": "rotary", "mass": mass_known or "unknown", "command_law": {"kind": "force"}}
    return diagnose(machine(signals=signals, encoder_resolution=count, **law), [run]).verdict


@pytest.mark.parametrize(("lag", "rate"), [(0.05, 100), (0.12, 100), (0.12, 50), (0.2, 200)])
def test_a_force_that_comes_late_is_a_lag_of_the_drive(lag, rate):
    verdict = swung(lag=lag, rate=rate)
    causes = {c.effect: c for c in verdict.causes}
    assert "sensor_delay" not in causes
    found = causes["drive_lag"].parameters["time_constant"]
    assert found.value == pytest.approx(lag, rel=0.15)
    assert causes["gravity_load"].parameters["arm"].value == pytest.approx(1.5, rel=0.1)
