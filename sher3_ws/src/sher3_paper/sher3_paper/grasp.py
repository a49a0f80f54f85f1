"""The deflection table: compliance of the grasping point, split between the delta stage and everything behind it.

The delta links alone explain a fifth of what was measured. The rest is put into a lumped compliance about the platform
centre, fitted to the means. The paper prints neither where the grasping point is nor whether springs were in; see
`Setup`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from sher3_description import Robot, load_robot
from sher3_kinematics.link_law import LinkLaw
from sher3_kinematics.tip_deflection import RIGID, ArmCompliance, TipDeflection

from sher3_paper.tables import DeflectionTable, deflection_table

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Setup:
    """What the paper leaves open about its deflection test.

    Attributes:
        lever: Vector from P to the grasping point (3,) [m]; an assumption from the dimensions of the arm.
        force: Force at which the secant is taken [N]; the printed forces range from -6 to 8 N.
        springs: Whether the links are pre-loaded by springs, as in the final robot.
    """

    lever: tuple[float, float, float] = (0.220, 0.0, 0.040)
    force: float = 7.0
    springs: bool = True


def grasp_compliance(robot: Robot, positions: Floats, setup: Setup, arm: ArmCompliance) -> Floats:
    """Return the secant compliances along x, y, z (n, 3) [m/N] of the grasp at platform positions (n, 2) [m]."""
    model = TipDeflection(robot, LinkLaw.of(robot, springs=setup.springs), arm)
    centres = np.column_stack((positions, np.zeros(len(positions))))
    lever = np.broadcast_to(np.array(setup.lever), centres.shape)
    result = np.empty((len(positions), 3))
    for axis in range(3):
        wrench = np.zeros((len(positions), 6))
        wrench[:, axis] = setup.force
        result[:, axis] = model.at_point(centres, lever, wrench)[:, axis] / setup.force
    return result


@dataclass(frozen=True)
class GraspModel:
    """The fitted series model against the printed table.

    Attributes:
        arm: fitted lumped compliance.
        model: compliances (n, 3) [m/N] of delta and arm in series.
        delta_only: of the delta stage alone (n, 3) [m/N].
        error: model / printed - 1 (n, 3).
        mean_error: mean model / mean printed - 1 (3,).
        setup: the assumptions.
    """

    arm: ArmCompliance
    model: Floats
    delta_only: Floats
    error: Floats
    mean_error: Floats
    setup: Setup

    @property
    def delta_share(self) -> Floats:
        """Share (3,) of the mean compliance that the delta stage explains."""
        return self.delta_only.mean(axis=0) / self.model.mean(axis=0)


def fit_grasp_model(
    robot: Robot | None = None, setup: Setup | None = None, table: DeflectionTable | None = None
) -> GraspModel:
    """Fit the arm's pitch, yaw and x compliance so that the table's three means are met."""
    machine, case = robot or load_robot(), setup or Setup()
    data = table or deflection_table()
    target = data.compliance.mean(axis=0)

    def arm_of(x: Floats) -> ArmCompliance:
        return ArmCompliance(pitch=float(np.exp(x[0])), yaw=float(np.exp(x[1])), along_x=float(x[2]) * 1e-6)

    def miss(x: Floats) -> Floats:
        return grasp_compliance(machine, data.positions, case, arm_of(x)).mean(axis=0) / target - 1.0

    found = least_squares(miss, [np.log(250.0), np.log(200.0), 15.0], xtol=1e-14, ftol=1e-14)
    arm = arm_of(found.x)
    model = grasp_compliance(machine, data.positions, case, arm)
    delta_only = grasp_compliance(machine, data.positions, case, RIGID)
    mean_error = model.mean(axis=0) / target - 1.0
    return GraspModel(arm, model, delta_only, model / data.compliance - 1.0, mean_error, case)
