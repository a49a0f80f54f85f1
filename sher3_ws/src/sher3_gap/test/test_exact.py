"""The exact stages re-executed by hand: the echo of a held command, and the host's law."""

import numpy as np
import pytest
from recorded import ROBOT, run, stroke
from sher3_gap.stages.exact.law import (
    controller_error,
    delayed,
    host_law,
    shifted,
    transport_error,
    with_lateness,
)

TOP = np.array([a.limits.velocity for a in ROBOT.actuators])


def test_a_delay_shifts_and_starts_at_zero():
    x = np.array([[1.0], [2.0], [3.0]])
    assert delayed(x, 1).ravel().tolist() == [0.0, 1.0, 2.0]
    assert delayed(x, 5).ravel().tolist() == [0.0, 0.0, 0.0]


def test_a_latency_of_a_part_of_a_period_mixes_two_commands():
    """0.25 periods late: three quarters of the command of the tick before, a quarter of the one before that."""
    x = np.array([[4.0], [8.0], [12.0], [16.0]])
    assert shifted(x, 0.25).ravel().tolist() == [0.0, 3.0, 7.0, 11.0]
    assert shifted(x, 1.0).ravel().tolist() == [0.0, 0.0, 4.0, 8.0]


def test_commands_in_time_leave_no_error():
    command = stroke(100)
    assert not transport_error(run(100, command=command, echo=delayed(command, 1))).any()
    late = transport_error(run(100, command=command, echo=delayed(command, 2)))
    assert np.abs(late[2:]).max() == pytest.approx(np.abs(np.diff(command, axis=0)).max(), rel=1e-3)
    assert transport_error(run(100, command=command)) is None


def test_the_host_law_is_set_point_velocity_plus_gain_times_error_and_clamped():
    signals = run(3, reference=1e-4, reference_velocity=1e-3, load=0.0, command=0.0)
    expected = np.minimum(1e-3 + ROBOT.position_gain * 1e-4, TOP)
    assert host_law(signals, ROBOT, ROBOT.position_gain) == pytest.approx(np.tile(expected, (3, 1)))
    far = run(3, reference=1.0, reference_velocity=0.0, load=0.0, command=0.0)
    assert host_law(far, ROBOT, ROBOT.position_gain) == pytest.approx(np.tile(TOP, (3, 1)))


def law_run(ticks=200, **extra):
    signals = run(ticks, reference=stroke(ticks), reference_velocity=stroke(ticks, 1e-3), load=0.9 * stroke(ticks))
    return run(
        ticks,
        reference=signals.reference,
        reference_velocity=signals.reference_velocity,
        load=signals.load,
        command=host_law(signals, ROBOT, ROBOT.position_gain),
        **extra,
    )


def test_a_host_that_keeps_the_law_leaves_no_error_and_a_lost_tick_does_not_count():
    assert not controller_error(law_run(), ROBOT).any()
    signals = law_run()
    signals.command[50] += 1e-3
    assert np.flatnonzero(controller_error(signals, ROBOT).any(axis=1)).tolist() == [50]
    lost = np.zeros(200, dtype=bool)
    lost[50] = True
    marked = law_run(lost=lost)
    marked.command[50] += 1e-3
    assert not controller_error(marked, ROBOT).any()


def test_a_reading_of_the_tick_before_is_marked_as_the_hosts_lateness():
    signals = law_run()
    earlier = run(
        200, reference=signals.reference, reference_velocity=signals.reference_velocity, load=delayed(signals.load, 1)
    )
    signals.command[100] = host_law(earlier, ROBOT, ROBOT.position_gain)[100]
    assert np.flatnonzero(with_lateness(signals, ROBOT).stale).tolist() == [100]
