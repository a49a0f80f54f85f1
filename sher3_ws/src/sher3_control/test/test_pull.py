"""A tare is refused while the drives hold something at the tool that the sensor would then call zero."""

from __future__ import annotations

import numpy as np
import pytest
from law_bench import ROBOT, SETTINGS
from sher3_common.samples import JointSample
from sher3_control.errors import TareRefused
from sher3_control.supervision.pull import Pull
from sher3_kinematics import RobotKinematics

KINEMATICS = RobotKinematics(ROBOT)
Q = (1e-3, -2e-3, 3e-3, 0.2, 1e-3)


def reports(wrench, count=SETTINGS.tare.samples, noise=0.17):
    """Return what drives report that hold the weights and a wrench on the tip in {b}, with the noise of the legs."""
    rng = np.random.default_rng(3)
    effort = KINEMATICS.gravity_load(Q) - KINEMATICS.jacobian(Q).T @ np.array(wrench)
    scatter = noise * np.array([1.0, 1.0, 1.0, 0.0, 0.0])
    return [JointSample(k, Q, None, tuple(effort + scatter * rng.standard_normal(5))) for k in range(count)]


@pytest.mark.parametrize(
    "wrench", [(0.0, 0.0, 0.3, 0.0, 0.0, 0.0), (0.3, 0.0, 0.0, 0.0, 0.0, 0.0), (0, 0, 0, 0.006, 0, 0)]
)
def test_a_load_that_the_drives_hold_is_no_zero(wrench):
    """0.3 N, or 6 mN m about the axis of roll: 0.4 N at the arm of 15 mm."""
    pull = Pull(KINEMATICS, SETTINGS)
    pull.hear(reports(wrench))
    with pytest.raises(TareRefused) as caught:
        pull.require_none()
    assert caught.value.reason == "pulled" and caught.value.value > caught.value.limit == 0.2
    assert "let go of the tool" in caught.value.remedy
    pull.hear(reports((0.0,) * 6))
    pull.require_none()


def test_without_a_report_of_efforts_nothing_is_said():
    pull = Pull(KINEMATICS, SETTINGS)
    pull.hear([JointSample(0, Q)])
    pull.require_none()


def test_efforts_that_are_no_numbers_are_no_rest():
    pull = Pull(KINEMATICS, SETTINGS)
    pull.hear([JointSample(0, Q, None, (float("nan"),) * 5)])
    with pytest.raises(TareRefused):
        pull.require_none()
