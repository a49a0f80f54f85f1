"""The kinematics against recorded runs: the pose of every tick, gravity at rest, and the weight of the tool."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from sher3_bags import read_case
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel.batch import tip_quaternion_batch
from sources import ROOT

SHARED = Path(os.environ.get("SHER3_SHARED", ROOT.parent / "shared"))
CASE = SHARED / "contract" / "practice" / "case_001"
PRINTED = 1e-11
"""The recorded poses are rounded to this [m, 1]."""

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not CASE.is_dir(), reason=f"no recorded case at {CASE}"),
]


@pytest.fixture(scope="module")
def case():
    return read_case(CASE)


def test_every_recorded_pose_is_computed_again(case):
    kinematics, ticks = RobotKinematics(case.robot), 0
    for run in case.runs:
        recorded = run["measured_cp"]
        rotations, positions = kinematics.transform_tip_to_base_batch(run["measured_js"].position)
        assert np.abs(positions - recorded.position).max() < PRINTED
        assert np.abs(tip_quaternion_batch(rotations) - recorded.orientation).max() < PRINTED
        ticks += len(positions)
    assert ticks > 10_000


def test_effort_of_the_first_tick_is_gravity(case):
    """A run starts at rest with the drives holding G less the contact wrench, which is none in these runs."""
    kinematics = RobotKinematics(case.robot)
    rated = np.array([actuator.drive.rated for actuator in case.robot.actuators])
    runs = [run for run in case.runs if not run.metadata.payload]
    errors = []
    for run in runs:
        load = kinematics.gravity_load(run["measured_js"].position[0])
        errors.append((run["drives/measured_js"].effort[0] - load) / rated)
    assert len(errors) >= 5
    assert np.abs(errors).max() < 5 * 0.002 + 0.001
    assert np.abs(np.mean(errors, axis=0)).max() < 4 * 0.002 / np.sqrt(len(errors)) + 0.0005
