"""How late a servo is does not depend on how fast it is logged."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_effects.delay import LONGEST_DELAY, tried
from slides import columns, machine

LATE = 0.15
SERVO = {"signals": columns("position", "reference"), "mass": None, "command_law": {"kind": "position"}}


def asked(t):
    return 0.3 * np.sin(1.3 * t) + 0.1 * np.sin(4.1 * t + 0.4) + 0.05 * np.sin(9.0 * t)


@pytest.mark.parametrize("period", [0.02, 0.005, 0.002])
def test_lag_and_dead_time_are_one_cause_of_the_right_sum(period):
    """From 50 to 500 Hz; a second dead time stood beside the lag where the first was tried up to 8 periods."""
    t = np.arange(0.0, 10.0, period)
    position = asked(t - LATE) + 1e-4 * np.random.default_rng(1).normal(size=len(t))
    run = AxesRun("run", period, {"slide": {"position": position, "reference": asked(t)}})
    (cause,) = diagnose(machine(**SERVO), [run]).verdict.causes
    sizes = {name: p.value for name, p in cause.parameters.items()}
    assert cause.effect in ("drive_lag", "command_delay")
    assert sizes.get("time_constant", 0.0) + sizes["delay"] == pytest.approx(LATE, rel=0.03)


@pytest.mark.parametrize("period", [0.05, 0.02, 0.004, 0.001])
def test_times_that_are_tried_reach_the_longest_delay_in_small_steps(period):
    times = np.array(tried((1.0, 2.0, 3.0, 4.0, 6.0, 8.0), period))
    assert times[-1] > LONGEST_DELAY / 1.5 and (times[1:] / times[:-1]).max() <= 2.0
