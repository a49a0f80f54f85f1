"""Deflection of the tip under a wrench on the tool, and its compensation: delta stage and arm in series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_common import Sher3Error
from sher3_common.compiled import direct
from sher3_description import Robot

from sher3_kinematics.arrays import vector
from sher3_kinematics.deflection import DeltaDeflection
from sher3_kinematics.kernel.deflection import tip_deflection
from sher3_kinematics.link_law import LinkLaw
from sher3_kinematics.robot_kinematics import RobotKinematics

Floats = NDArray[np.float64]
ABSURD_FORCE = 1e6
"""Link force [N] that a load within the sensor's range causes only near a singularity."""


class LoadBeyondRange(Sher3Error):
    """A wrench beyond what the force sensor measures; carries `component` and its value [N or N m]."""

    def __init__(self, component: str, *, value: float, limit: float) -> None:
        unit = "N" if component.startswith("f") else "N m"
        remedy = "reduce the load, or ask about a load that the sensor can measure"
        super().__init__(f"{component} exceeds the sensor's range [{unit}]", value=value, limit=limit, remedy=remedy)
        self.component = component


@dataclass(frozen=True)
class ArmCompliance:
    """Everything behind the delta links (rails, roll, tilt, arm, stand), lumped about the platform centre.

    The defaults reproduce the means of the paper's deflection table (C_x 23.2, C_y 280, C_z 240 um/N at the grasp)
    in series with the sprung delta at 7 N and the grasping point 220 mm along x and 40 mm above P, an assumption;
    `sher3 paper` recomputes them. A rotation about x has not been measured and is rigid.

    Attributes:
        pitch, yaw: rotational stiffness about y and z of {b} [N m/rad].
        along_x: translational compliance [m/N].
    """

    pitch: float = 244.0
    yaw: float = 213.0
    along_x: float = 15e-6

    def deflection(self, wrench: Floats) -> Floats:
        """Return the deflection (..., 6) at the platform centre for a wrench (..., 6) at it."""
        result = np.zeros(np.shape(wrench))
        result[..., 0] = self.along_x * wrench[..., 0]
        result[..., 4] = wrench[..., 4] / self.pitch
        result[..., 5] = wrench[..., 5] / self.yaw
        return result


RIGID = ArmCompliance(pitch=np.inf, yaw=np.inf, along_x=0.0)
"""An arm that does not give way."""


class TipDeflection:
    """Deflection of the tip of one robot.

    Attributes:
        kinematics: of the same robot.
        delta: elastic delta stage.
        arm: lumped compliance in series.
    """

    def __init__(self, robot: Robot, law: LinkLaw | None = None, arm: ArmCompliance | None = None) -> None:
        """Take geometry and link law (with springs) from the robot, the arm's compliance from the paper's table."""
        self.kinematics = RobotKinematics(robot)
        self.delta = DeltaDeflection(robot, law)
        self.arm = ArmCompliance() if arm is None else arm
        sensor = robot.force_sensor
        self._range = np.array([*sensor.range_force, *sensor.range_torque])
        self._sensor_position = np.array(sensor.position)
        law, arm = self.delta.law, self.arm
        constants = [self.delta.link_length, law.a * law.factor, law.b, law.force_floor**2]
        constants += [1.0 / arm.pitch, 1.0 / arm.yaw, arm.along_x, *self._range, *self._sensor_position, ABSURD_FORCE]
        self._geometry = self.delta.platform, self.delta.base, np.array(constants)
        self._values = np.array(self.kinematics.parameters)
        self._deflection = direct(tip_deflection, self._values, np.zeros(5), np.zeros(6), *self._geometry)

    def at_point(self, centre: Floats, lever: Floats, wrench: Floats) -> Floats:
        """Return the deflection (..., 6) of a point under a wrench (..., 6) that acts there.

        Args:
            centre: platform centre (..., 3) [m] in {b}.
            lever: the point seen from the platform centre (..., 3) [m] in {b}.
            wrench: force and moment (..., 6) at the point, axes of {b}.
        """
        at_platform = np.array(wrench, dtype=float)
        at_platform[..., 3:] += np.cross(lever, at_platform[..., :3])
        moved = self.delta.deflection(centre, at_platform) + self.arm.deflection(at_platform)
        moved[..., :3] += np.cross(moved[..., 3:], lever)
        return moved

    def __call__(self, q: Sequence[float] | Floats, wrench: Sequence[float] | Floats) -> Floats:
        """Return the deflection (6,) of the tip in {b} for actuator positions (5,) and a wrench (6,) at the tip in {b}.

        Raises:
            LoadBeyondRange: the wrench, seen by the force sensor, exceeds its range.
        """
        positions, load = vector(q, 5, "actuator positions"), vector(wrench, 6, "wrench at the tip")
        moved: Floats
        moved, usable = self._deflection(self._values, positions, load, *self._geometry)
        if usable:
            return moved
        # What is wrong is said by the model that is checked step by step.
        transform = self.kinematics.transform_tip_to_base(positions)
        self._require_measurable(transform[:3, :3], load)
        centre = self.kinematics.delta.forward(positions[:3])
        return self.at_point(centre, transform[:3, 3] - centre, load)

    def compensated(
        self, q: Sequence[float] | Floats, wrench: Sequence[float] | Floats, position: Sequence[float] | Floats
    ) -> Floats:
        """Return the tip position (3,) [m] to command so that the deflected tip is where `position` (3,) says.

        This is the first-order correction: the deflection at the present pose is subtracted. The correction is a
        fraction of a millimetre, and the deflection changes over it by a quantity of second order only.
        """
        return vector(position, 3, "tip position") - self(q, wrench)[:3]

    def _require_measurable(self, rotation: Floats, wrench: Floats) -> None:
        force, moment = rotation.T @ wrench[:3], rotation.T @ wrench[3:]
        x, y, z = self._sensor_position
        lever = np.array([y * force[2] - z * force[1], z * force[0] - x * force[2], x * force[1] - y * force[0]])
        seen = np.concatenate((force, moment - lever))
        if (np.abs(seen) <= self._range).all():
            return
        worst = int(np.argmax(np.abs(seen) / self._range))
        names = ("fx", "fy", "fz", "tx", "ty", "tz")
        raise LoadBeyondRange(names[worst], value=float(seen[worst]), limit=float(self._range[worst]))
