"""How a controller takes its speed, read off a log that is slower than it."""

import numpy as np
import pytest
from sher3_chain.axes.command.sampling import FASTER, Pace, speed_of

PERIOD = 1e-3


@pytest.mark.parametrize("rows", [3, 4, 5, 6, 8, 12])
@pytest.mark.parametrize("seed", range(3))
def test_a_speed_over_two_periods_of_the_controller_is_told_from_its_neighbours(rows, seed):
    """A path of four sines up to 5 Hz; the log holds 17 rows of their period or more."""
    t, rng = PERIOD * np.arange(4000), np.random.default_rng(seed)
    q = sum(
        rng.uniform(0.5, 2.0) / f * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.0)) for f in rng.uniform(1, 5, 4)
    )
    true = ((q[2:] - q[:-2]) / (2.0 * PERIOD))[rows - 2 :: rows]
    error = {}
    for pace in FASTER:
        speed = speed_of(q[::rows], rows * PERIOD, pace)
        error[pace] = np.std((speed[1:][: len(true)] - true[: len(speed) - 1])[9:-9])
    own = error.pop(Pace(2.0 / rows))
    assert own < 0.05 * min(error.values())
