"""Pendulums that are let go: the friction that stops them is found with coarse encoders as with fine ones."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_chain.axes.view import AxisView
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.cut_off import cut_off
from sher3_chain.readings.signals import signals_of
from sher3_diagnosis import diagnose
from slides import axis_of, machine

INERTIA, ARM, PERIOD, FINE = 0.02, 0.65, 0.005, 20
FREE = {
    "name": "slide",
    "motion": "rotary",
    "signals": {"position": {"column": "position", "unit": "rad"}},
    "command_law": {"kind": "none"},
    "mass": INERTIA,
    "gravity": {"arm": ARM},
}


def swing(coulomb, start=2.9, seconds=40.0):
    """A pendulum from rest: (n,) rad about the place where it hangs, by midpoint steps."""
    h, q, v, path = PERIOD / FINE, start, 0.0, []
    for _ in range(int(seconds / PERIOD)):
        path.append(q)
        for _ in range(FINE):
            a = -float(ARM * np.sin(q + 0.5 * h * v) + coulomb * np.tanh(v / 1e-3)) / INERTIA
            q, v = q + h * (v + 0.5 * h * a), v + h * a
    return np.array(path)


def run_of(path, count):
    return AxesRun("run", PERIOD, {"slide": {"position": np.round(path / count) * count}})


@pytest.mark.parametrize("count", [1e-4, 2.0 * np.pi / 2000.0])
def test_friction_that_stops_a_pendulum_is_found_whatever_its_encoder_counts(count):
    """4 mN m beside a weight of 0.65 N m are seen at the frequencies of the swing where the counts are coarse."""
    verdict = diagnose(machine(**FREE, encoder_resolution=count), [run_of(swing(4e-3), count)]).verdict
    (cause,) = verdict.causes
    assert verdict.status == "attributed" and cause.effect == "coulomb_friction"
    force = cause.parameters["force"]
    assert force.value == pytest.approx(4e-3, rel=0.1) and force.low <= 4e-3 <= force.high


def test_a_weight_goes_through_the_filter_as_the_acceleration_does():
    """Without friction nothing is left of a wide swing, however low the cut-off: 0.5 N m of weight cancel to 0.1 %."""
    path, axis = swing(0.0, seconds=20.0), axis_of(**FREE, encoder_resolution=1e-9)
    signals = signals_of(run_of(path, 1e-9), axis, "run")
    for cut in (3.0, 40.0):
        view = AxisView(replace(signals, bandwidth=cut), axis, INERTIA)
        left = view.inertial[view.in_motion, 0]
        assert np.std(left) < 1e-3 * np.std(view.path.gravity)


def test_what_is_judged_of_a_free_swing_is_what_its_weight_leaves():
    """Coarse counts are a small share of the acceleration, and all of what friction is."""
    count = 2.0 * np.pi / 2000.0
    path = run_of(swing(4e-3), count).signals["slide"]["position"]
    assert cut_off(path, PERIOD, 40.0, free=True) < 0.5 * cut_off(path, PERIOD, 40.0)
