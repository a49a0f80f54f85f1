"""Floors of an axis: innovations, rounding, repeats."""

import numpy as np
import pytest
from sher3_chain.axes.evidence import residuals_of
from sher3_chain.axes.floors import floors_of, reading_floors
from sher3_chain.axes.view import AxisView
from sher3_chain.floors.innovation import innovation, white_behind
from sher3_chain.readings.signals import AxisSignals
from sher3_diagnosis.channel import Channel, Residual
from slides import axis_of, columns

MOTOR, LINK = Channel("motor_mechanics", "slide"), Channel("transmission", "slide")


def residual(values):
    return Residual(np.asarray(values, dtype=float)[:, None], np.ones(len(values), dtype=bool))


def test_the_innovation_of_white_noise_is_its_deviation():
    assert innovation(residual(2.0 * np.random.default_rng(0).normal(size=20000))) == pytest.approx([2.0], rel=0.03)


def test_lines_and_rare_steps_are_foreseen():
    line = 3.0 * np.arange(200)
    assert innovation(residual(line)) == pytest.approx([0.0], abs=1e-9)
    assert innovation(residual(line + np.where(np.arange(200) < 100, 0.0, 50.0))) == pytest.approx([0.0], abs=1e-9)


def test_noise_makes_as_much_acceleration_as_is_reckoned_of_it():
    """Behind the filter and away from its ends, which would hold most of it: 10 000 samples at 1 kHz, cut at 40 Hz."""
    noise = np.random.default_rng(1).normal(size=(10_000, 1))
    run = AxisSignals("run", "run", 0.001, noise, bandwidth=40.0)
    ok = run.inner
    place, _, bend = white_behind(run)
    assert run.smooth[run.grid][ok].std() == pytest.approx(place, rel=0.1)
    assert run.to_grid(run.acceleration)[ok].std() == pytest.approx(bend, rel=0.1)


def servo(position, reference, count=0.012):
    run = AxisSignals("run", "repeats", 0.02, position[:, None], reference=reference[:, None], bandwidth=10.0)
    axis = axis_of(
        motion="rotary",
        signals=columns("position", "reference", unit="rad"),
        command_law={"kind": "position"},
        encoder_resolution=count,
    )
    return AxisView(run, axis, 0.0)


def test_rounding_to_a_count_is_a_twelfth_of_its_square():
    """A servo's count of 0.012 rad: 0.012 / sqrt(12); two encoders round both."""
    floors = reading_floors(servo(np.zeros(100), np.zeros(100)))
    assert floors[MOTOR] == pytest.approx([0.012 / np.sqrt(12.0)])
    assert floors[LINK] == pytest.approx([0.012 / np.sqrt(6.0)])


def test_rounding_of_a_position_makes_a_force_in_proportion_to_the_mass():
    run = AxisSignals("run", "run", 0.002, np.zeros((2000, 1)))
    one, three = (reading_floors(AxisView(run, axis_of(encoder_resolution=1e-6), m))[MOTOR] for m in (1.0, 3.0))
    assert three == pytest.approx(3.0 * one)


def test_repeats_tell_the_floor_where_they_differ_by_more_than_a_count():
    """Errors of 0.1 and 0.3 rad all along: half of 0.2 squared, root of it 0.141."""
    records = [servo(np.full(400, -e), np.zeros(400)) for e in (0.1, 0.3)]
    found = [residuals_of(view) for view in records]
    assert floors_of(records, found, repeats=True)[0][MOTOR] == pytest.approx([0.2 / np.sqrt(2.0)])
    assert floors_of(records, found, repeats=False)[0][MOTOR] == pytest.approx([0.012 / np.sqrt(12.0)])


@pytest.mark.parametrize("noise", [1e-5, 1e-4, 1e-3])
def test_a_force_without_noise_is_known_no_better_than_the_motion_beside_it(noise):
    """5 N at about 0.1 m/s: as a viscous friction 50 N/(m/s), times the noise of the speed behind the filter."""
    clock = 0.002 * np.arange(10_000)
    q = 0.1 * clock + noise * np.random.default_rng(2).normal(size=len(clock))
    force = np.full((len(clock), 1), 5.0)
    run = AxisSignals("run", "run", 0.002, q[:, None], effort=force, bandwidth=5.0)
    view = AxisView(run, axis_of(mass="unknown", encoder_resolution=1e-7), 0.0)
    ok = run.inner
    (floor,) = floors_of([view], [residuals_of(view)], repeats=False)[0][MOTOR]
    assert floor == pytest.approx(50.0 * view.velocity[ok, 0].std(), rel=0.2)
