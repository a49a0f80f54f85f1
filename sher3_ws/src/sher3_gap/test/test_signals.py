"""What a run's masks and grids are, tick by tick."""

import numpy as np
import pytest
from recorded import PERIOD, run, stroke


def test_the_grid_is_that_of_the_tracker_and_its_ends_do_not_count():
    signals = run(400)
    assert signals.stride == round(0.01 / PERIOD)
    assert (np.diff(signals.grid) == signals.stride).all()
    edge = 0.05 / PERIOD
    inside = (signals.grid >= edge) & (signals.grid < 400 - edge)
    assert (signals.inner == inside).all() and inside.any()


def test_a_lost_tick_spoils_what_is_near_and_starts_a_new_piece():
    lost = np.zeros(400, dtype=bool)
    lost[200] = True
    signals = run(400, lost=lost)
    near = np.abs(signals.grid - 200) <= 0.05 / PERIOD
    assert not signals.inner[near].any()
    assert signals.pieces[0] == 0 and signals.pieces[-1] == 1
    assert not signals.command_counts[200] and signals.command_counts.sum() == 399


def test_the_echo_tells_nothing_at_the_start_when_held_and_behind_a_lost_tick():
    lost, held = np.zeros(20, dtype=bool), np.zeros(20, dtype=bool)
    lost[10], held[5] = True, True
    assert np.flatnonzero(~run(20, lost=lost, held=held).echo_tells).tolist() == [0, 5, 10, 11, 12]


def test_velocity_and_acceleration_are_differences_of_the_position():
    ramp = run(400, motor=np.outer(PERIOD * np.arange(400), np.ones(5)))
    assert ramp.velocity[100:300] == pytest.approx(1.0, rel=1e-3)
    assert ramp.acceleration[1:-1] == pytest.approx(0.0, abs=1e-3)
    kink = np.zeros((400, 5))
    kink[200:] = 1.0
    assert run(400, motor=kink).acceleration[199, 0] == pytest.approx(1.0 / PERIOD**2)


def test_samples_of_a_tracker_are_put_to_the_nearest_of_the_grid():
    signals = run(400, tracker_index=np.array([0, 3, 397]))
    stride = signals.stride
    assert signals.tracker_slot.tolist() == [0, round(3 / stride), len(signals.grid) - 1]


def test_a_load_is_known_unless_the_run_says_otherwise():
    assert run(400).loaded_ok.all()
    known = np.arange(400) < 200
    assert (run(400, contact_known=known).loaded_ok == known[run(400).grid]).all()


def test_to_grid_samples_the_filtered_signal():
    signals = run(400, motor=stroke())
    assert signals.to_grid(signals.motor) == pytest.approx(signals.smooth[signals.grid])
