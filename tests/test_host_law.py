"""The host law against recorded runs: every commanded velocity, bit for bit."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from sher3_bags import read_case
from sher3_control import position_commands
from sources import ROOT

SHARED = Path(os.environ.get("SHER3_SHARED", ROOT.parent / "shared"))
CASE = SHARED / "contract" / "practice" / "case_001"


@pytest.mark.shared
@pytest.mark.skipif(not CASE.is_dir(), reason=f"no recorded case at {CASE}")
def test_every_recorded_command_of_the_healthy_case_is_computed_again():
    case = read_case(CASE)
    limit = np.array([actuator.limits.velocity for actuator in case.robot.actuators])
    ticks = 0
    for run in case.runs:
        reference, measured, command = run["setpoint_js"], run["measured_js"], run["servo_jv"]
        assert np.array_equal(reference.stamp, measured.stamp)
        assert np.array_equal(reference.stamp, command.stamp)
        again = position_commands(
            reference.position, reference.velocity, measured.position, case.robot.position_gain, limit
        )
        assert again.tobytes() == command.velocity.tobytes()
        ticks += len(again)
    assert ticks > 10000
