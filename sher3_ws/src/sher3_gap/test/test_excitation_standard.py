"""The standard excitations keep the limits, are smooth, scale, and end at rest."""

import numpy as np
import pytest
from sher3_description import ACTUATORS, load_robot
from sher3_gap.excitation import POSTURES, ExcitationError, catalogue, excite

ROBOT = load_robot()
SMOOTH = list(catalogue())


def test_catalogue_names_purpose_and_separations():
    entries = catalogue()
    assert list(entries) == ["reversals", "sweep", "steps", "loads", "postures", "task"]
    assert all(entry.purpose and len(entry.purpose) > 20 for entry in entries.values())
    assert all(entry.separates for name, entry in entries.items() if name != "task")


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("duration", [4.6, 12.0])
def test_set_points_are_consistent_and_within_limits(name, posture, duration):
    e = excite(name, ROBOT, posture=posture, duration=duration)
    assert e.position.shape == e.velocity.shape == (round(duration / 0.002), 5)
    for j, actuator in enumerate(ROBOT.actuators):
        limits = actuator.limits
        q, v = e.position[:, j], e.velocity[:, j]
        assert limits.lower < q.min() and q.max() < limits.upper
        assert np.abs(v).max() <= limits.velocity
        # velocity is the derivative of position: compare with the trapezoid's exact order of error
        drift = np.abs(np.cumsum((v[1:] + v[:-1]) * 0.001) - (q[1:] - q[0])).max()
        assert drift < 5e-4 * np.ptp(q) + 1e-12, ACTUATORS[j]
        assert np.abs(np.diff(v)).max() / 0.002 <= limits.acceleration
    np.testing.assert_allclose(e.position[0], POSTURES[posture])
    np.testing.assert_array_equal(e.velocity[[0, -1]], 0.0)


def test_acceleration_is_continuous():
    """Halving the period halves the largest step of the acceleration: no jumps at the joints of the track."""
    fine = ROBOT.replace({"control_period": 0.001})
    for name in ("reversals", "sweep", "steps", "postures", "task"):
        steps = []
        for robot in (ROBOT, fine):
            e = excite(name, robot)
            steps.append(np.abs(np.diff(np.diff(e.velocity, axis=0) / robot.control_period, axis=0)).max(axis=0))
        assert np.all(steps[1] < 0.65 * steps[0]), name


def test_amplitude_scales_motion_and_loads():
    whole, part = excite("sweep", ROBOT), excite("sweep_0.5", ROBOT)
    assert (part.label, part.amplitude, whole.label) == ("sweep_0.5", 0.5, "sweep")
    assert np.all(np.ptp(part.position, axis=0) < 0.6 * np.ptp(whole.position, axis=0))
    assert excite("loads_0.8", ROBOT).loads[0][2] == pytest.approx(0.96)


def test_contact_wrench_is_constant_on_the_plateaus_and_zero_far_from_them():
    e = excite("loads", ROBOT)
    wrench = e.contact_wrench()
    for start, end, *force in e.loads:
        on = (e.time >= start) & (e.time <= end)
        np.testing.assert_allclose(wrench[on, :3], np.tile(force, (on.sum(), 1)))
    assert len(e.loads) == 6 and not wrench[0].any() and not wrench[-1].any()
    assert e.metadata(2, seed=7).to_record()["payload"].startswith("[[0.36")


def test_axes_do_not_move_in_step():
    v = excite("reversals", ROBOT).velocity
    moving = (np.abs(v) > 1e-9).astype(float)
    correlation = np.corrcoef(v.T / np.abs(v).max(axis=0)[:, None])
    assert np.abs(correlation - np.eye(5)).max() < 0.8 and moving.mean() > 0.2


def test_jumps_are_for_plants_only():
    jumping = excite("steps", ROBOT, set_point_jumps=True)
    assert not jumping.velocity.any() and np.abs(np.diff(jumping.position[:, 0])).max() > 1e-4
    assert jumping.label == "steps"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"label": "wobble"}, "no such excitation"),
        ({"label": "sweep_9"}, "amplitude out of range"),
        ({"label": "sweep", "posture": "p9"}, "no such posture"),
        ({"label": "sweep", "duration": 0.5}, "duration out of range"),
    ],
)
def test_bad_requests_are_named(arguments, words):
    with pytest.raises(ExcitationError, match=words):
        excite(arguments.pop("label"), ROBOT, **arguments)


def test_limits_are_enforced_with_their_numbers():
    slow = ROBOT.replace({"actuators[1].limits.acceleration": 0.05})
    narrow = ROBOT.replace({"actuators[1].limits.upper": 0.001})
    with pytest.raises(ExcitationError, match="delta_2: position below") as caught:
        excite("postures", narrow)
    assert caught.value.actuator == "delta_2" and caught.value.value > 0
    excite("reversals", slow)  # slower moves, not an error: durations follow the limits
