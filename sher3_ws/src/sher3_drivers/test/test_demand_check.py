"""The echo of the demand against what was sent: exact drives never object, disobedient ones soon."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.demand import DemandCheck

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
SETTINGS = default_settings(ROBOT.control_period)
TICKS = round(SETTINGS.obey_latency / SETTINGS.period)


def counts(velocity):
    return [scale.velocity_counts(velocity) for scale in SCALES]


def run(sent, executed):
    """Return the first trip and its tick; both are lists of velocities, one per tick, of all axes.

    The echo of a tick comes before its command.
    """
    check = DemandCheck(SCALES, SETTINGS)
    for tick, (command, echo) in enumerate(zip(sent, executed, strict=True)):
        if trip := check.check(tuple(n * s.velocity for n, s in zip(counts(echo), SCALES, strict=True))):
            return trip, tick
        check.sent(counts(command))
    return None, len(sent)


@given(st.lists(st.floats(-0.012, 0.012), min_size=5, max_size=60), st.integers(0, TICKS - 1))
def test_a_drive_that_is_late_by_less_than_the_latency_is_no_offence(velocities, late):
    executed = [velocities[max(0, k - 1 - late)] for k in range(len(velocities))]
    assert run(velocities, executed)[0] is None


def test_the_mean_of_two_commands_is_no_offence():
    velocities = [0.005 * (k % 2) for k in range(50)]
    assert run(velocities, [0.0, 0.0] + [0.0025] * 48)[0] is None


def test_a_drive_that_keeps_its_velocity_is_found_within_the_latency_and_a_few_micrometres():
    velocities = [0.005] * 20 + [0.0] * 40
    trip, tick = run(velocities, [0.005] * 60)
    assert trip is not None and trip.reason is Reason.DRIVE_DISOBEYS
    assert 20 < tick <= 20 + SETTINGS.obey_latency / SETTINGS.period
    assert trip.text.startswith("delta_1: executes 0.005 m/s, was sent 0 m/s")


def test_a_drive_that_runs_the_other_way_is_found_at_once():
    assert run([0.0] * 10 + [0.005] * 10, [0.0] * 11 + [-0.005] * 9)[1] <= 12


def test_what_strayed_little_is_forgotten():
    """A single echo that is 0.25 mm/s off is half the limit; ten of them a second apart never add up."""
    executed = [0.00025 if k % 500 == 10 else 0.0 for k in range(5000)]
    assert run([0.0] * 5000, executed)[0] is None
