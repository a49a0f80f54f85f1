"""What the readings alone resolve, by hand from robot.yaml."""

from types import SimpleNamespace

import numpy as np
import pytest
from recorded import PERIOD, ROBOT, run, stroke
from sher3_diagnosis.channel import Channel, Residual
from sher3_gap.stages.floors import astray, averaged, chatter_floors, floors, resolution_floors

TRANSMISSION = Channel("transmission", "delta_1")
AXIS = ROBOT.actuators[0]


def test_two_encoders_resolve_their_counts_over_the_root_of_twelve():
    found = resolution_floors(ROBOT, PERIOD)
    expected = np.hypot(AXIS.motor_encoder, AXIS.load_encoder) / np.sqrt(12.0)
    assert found[TRANSMISSION] == pytest.approx([expected])
    tip = found[Channel("mechanism", "tip")]
    assert tip == pytest.approx(np.repeat([ROBOT.tracker.noise_position, ROBOT.tracker.noise_rotation], 3))


def test_an_axis_at_rest_may_chatter_between_two_counts_and_a_moving_one_does_not():
    assert Channel("drive", "delta_1") in chatter_floors(run(2000), ROBOT)
    assert chatter_floors(run(2000, motor=stroke(2000)), ROBOT) == {}


def test_rounding_averages_out_where_many_counts_are_crossed():
    assert averaged(run(2000, motor=stroke(2000)), ROBOT, TRANSMISSION)
    assert not averaged(run(2000), ROBOT, TRANSMISSION)
    assert not averaged(run(2000, motor=stroke(2000)), ROBOT, Channel("drive", "delta_1"))


def test_the_largest_of_repeats_resolution_and_twin_counts():
    """Repeats that differ by 2: floor 2 / sqrt(2). A twin of rms 5 is above that."""
    ok = np.ones(100, dtype=bool)
    residuals = [{TRANSMISSION: Residual(np.full((100, 1), v), ok)} for v in (0.0, 2.0)]
    twin = {TRANSMISSION: Residual(np.full((100, 1), 5.0), ok)}
    runs = [run(2000), run(2000)]
    alone = floors(runs, residuals, [[], []], ROBOT)
    assert alone[0][TRANSMISSION] == pytest.approx([np.sqrt(2.0)])
    assert floors(runs, residuals, [[twin], []], ROBOT)[0][TRANSMISSION] == pytest.approx([5.0])


def test_a_tip_that_turns_under_a_load_leaves_open_how_the_load_reads():
    """0.01 rad under 2 N: 0.02 N; 50 um under 2 N: 0.1 mN m; without a tracker nothing is known."""
    n = 10
    wrench, error = np.zeros((n, 6)), np.zeros((n, 6))
    wrench[:, 2], error[:, 0], error[:, 3] = 2.0, 50e-6, 0.01
    geometry = SimpleNamespace(path=lambda run: SimpleNamespace(contact_wrench=wrench), tip_error=lambda run: error)
    seen = SimpleNamespace(tracker_position=error, tracker_index=np.arange(n))
    loaded = np.arange(n) > 4
    assert astray(seen, geometry, loaded) == pytest.approx([0.02] * 3 + [1e-4] * 3)
    assert not astray(SimpleNamespace(tracker_position=None, tracker_index=None), geometry, loaded).any()
