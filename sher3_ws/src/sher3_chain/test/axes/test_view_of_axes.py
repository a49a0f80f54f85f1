"""One axis as effects and engine see it: nominal forces, motion, rest and release."""

import numpy as np
import pytest
from sher3_chain.axes.view import AxisView
from sher3_chain.readings.signals import AxisSignals
from slides import axis_of


def view(position, period=0.01, mass=2.0, **changes):
    return AxisView(AxisSignals("run", "sweep", period, np.asarray(position)[:, None]), axis_of(**changes), mass)


def test_the_nominal_force_is_inertia_viscosity_and_weight():
    """At 0.1 m/s, 2 kg, 5 N/(m/s) and a weight of 3 N: 0.5 N + 3 N."""
    seen = view(0.1 * 0.01 * np.arange(400), viscous=5.0, gravity={"constant": 3.0})
    assert seen.inertial[seen.run.inner][:, 0] == pytest.approx(3.5, abs=1e-6)
    assert seen.path.gravity == pytest.approx(3.0) and not seen.path.contact_force.any()


def test_a_pendulum_weighs_by_the_sine_from_where_it_hangs():
    seen = view(np.full(200, 0.5 * np.pi), motion="rotary", gravity={"arm": 4.0})
    assert seen.path.gravity[50:-50] == pytest.approx(4.0)
    assert view(np.zeros(200), motion="rotary", gravity={"arm": 4.0}).path.gravity == pytest.approx(0.0)


def test_what_stands_for_an_unknown_lead():
    stroke = 0.5 * np.linspace(0.0, 1.0, 200)
    assert view(stroke, lead=0.004).lead("slide") == 0.004
    assert view(stroke).lead("slide") == pytest.approx(0.01)  # a fiftieth of the stroke
    assert view(stroke, motion="rotary").lead("slide") == pytest.approx(2.0 * np.pi)
    assert view(stroke).motion("slide").lead is None  # which names no phase of a turn
    assert view(stroke, lead=0.004).motion("slide").lead == 0.004


def test_rest_motion_and_release_of_an_axis_that_is_let_go():
    """Held for 2 s, moving for 2 s, at rest again: what holds it before is not known."""
    position = np.r_[np.zeros(200), 0.1 * np.linspace(0.0, 1.0, 200), np.full(200, 0.1)]
    free = view(position, command_law={"kind": "none"}, encoder_resolution=1e-5)
    assert free.release == pytest.approx(200, abs=5)
    assert not free.at_rest[:190].any() and free.at_rest[450:590].all()
    assert free.in_motion[210:390].all() and not free.in_motion[:190].any() and not free.in_motion[420:].any()
    driven = view(position, encoder_resolution=1e-5)
    assert driven.at_rest[20:190].all()


def test_a_stop_between_two_samples_of_the_grid_is_rest():
    """A stop of 8 ms at 1 m into a stroke of 1 m/s, read at 1 kHz; a turn of 10 m/s^2 without a stop is none."""
    clock = 0.001 * np.arange(2000)
    stopped = view(np.where(clock < 1.0, clock, np.maximum(clock - 0.008, 1.0)), period=0.001, encoder_resolution=1e-6)
    assert not stopped.in_motion[98:104].any() and stopped.in_motion[20:95].all() and stopped.in_motion[106:180].all()
    turned = view(5.0 * (clock - 1.0) ** 2, period=0.001, encoder_resolution=1e-6)
    assert turned.moving[20:180].sum() >= 159


def test_what_the_engine_reads():
    seen = view(0.1 * 0.01 * np.arange(400), lead=0.004)
    assert seen.excitation == "sweep" and seen.rate == 100.0
    assert seen.speed_share[50:-50] == pytest.approx(1.0, rel=1e-3)
    told = seen.quantities("slide")
    assert seen.inputs("slide").shape == (400, sum(x.shape[1] for x in told.values()))
    assert told["direction"][-50:, 0] == pytest.approx(1.0)
    assert not (seen.loaded.any() or seen.warmth.any() or seen.temperature_known)
    assert seen.axis("slide").mass == 2.0 and seen.row("slide") == 0


def test_the_sliding_state_builds_up_over_its_displacement():
    """Dahl after a travel of one displacement: 1 - 1 / e."""
    seen = view(1e-3 * np.linspace(0.0, 1.0, 4001), period=0.001)
    assert seen.sliding(0, 1e-3)[-1] == pytest.approx(1.0 - np.exp(-1.0), abs=0.01)
    assert seen.sliding(0, 1e-3) is seen.sliding(0, 1e-3)
