"""Poses and robots that the tests share."""

import numpy as np
import pytest
from sher3_description import Robot, load_robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel.parameters import KernelParameters, kernel_parameters


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot()


@pytest.fixture(scope="session")
def kinematics() -> RobotKinematics:
    return RobotKinematics()


@pytest.fixture(scope="session")
def workspace_q(kinematics: RobotKinematics) -> np.ndarray:
    """Actuator positions (n, 5) over the whole workspace: everywhere within travel and least leg elevation."""
    rng = np.random.default_rng(20240501)
    q = rng.uniform(kinematics.lower, kinematics.upper, (20_000, 5))
    least = kinematics.delta.least_elevation
    inside = [kinematics.singularity_distance(row).distance >= least for row in q]
    return np.ascontiguousarray(q[inside])


@pytest.fixture(scope="session")
def as_built(robot: Robot) -> KernelParameters:
    """Every kind of geometric error at once, ten times larger than any real one."""
    return kernel_parameters(robot)._replace(
        link_1=0.0643,
        link_2=0.0638,
        anchor_1x=0.0327,
        anchor_2y=0.0290,
        anchor_3z=0.0004,
        rail_1x=0.01,
        rail_2y=-0.02,
        rail_3x=0.015,
        zero_1=0.0002,
        zero_4=0.01,
        zero_5=-0.0002,
        base_x=0.02,
        base_y=-0.03,
        base_z=0.01,
        d1=0.061,
        tool_y=0.002,
        crank=0.0283,
        coupler=0.0695,
        offset=0.0143,
    )


@pytest.fixture(scope="session", params=["nominal", "as built"])
def any_kinematics(request: pytest.FixtureRequest, robot: Robot, as_built: KernelParameters) -> RobotKinematics:
    return RobotKinematics(robot, None if request.param == "nominal" else as_built)
