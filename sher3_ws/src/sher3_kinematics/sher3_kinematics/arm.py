"""The serial arm, and the whole robot behind a freely translating platform, as Pinocchio models of the same parameters.

The closed forms of this package do not use them; they are the second formulation, and the door to rigid-body dynamics.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from sher3_description import Robot
from sher3_description.urdf import urdf

from sher3_kinematics.arrays import Floats, vector


def whole_robot_model(robot: Robot) -> pin.Model:
    """Return the model of the URDF: sliders, platform translation, roll, tilt angle; gravity along -z of {b}."""
    return pin.buildModelFromXML(urdf(robot))


class Arm:
    """The arm from the platform to the tip, coordinates (roll, tilt angle) [rad].

    Attributes:
        model: Pinocchio model, joints `roll` and `tilt_angle`, frames `p`, `r`, `a`, `t`, `f`; its universe is {p}.
    """

    def __init__(self, robot: Robot) -> None:
        """Build the model from the arm's offsets and masses."""
        arm, sensor = robot.arm, robot.force_sensor
        model = pin.Model()
        model.name = "arm"
        roll = model.addJoint(0, pin.JointModelRX(), _at(0.0, 0.0, arm.d1), "roll")
        tilt = model.addJoint(roll, pin.JointModelRY(), _at(arm.d2, 0.0, arm.d3), "tilt_angle")
        model.appendBodyToJoint(roll, _point_mass(arm.roll_mass, arm.roll_com), pin.SE3.Identity())
        model.appendBodyToJoint(tilt, _point_mass(arm.tilt_mass, arm.tilt_com), pin.SE3.Identity())
        tip = _at(*arm.tool)
        frames = (("p", 0, _at()), ("r", roll, _at()), ("a", tilt, _at()), ("t", tilt, tip))
        for name, joint, placement in (*frames, ("f", tilt, tip * _at(*sensor.position))):
            model.addFrame(pin.Frame(name, joint, placement, pin.FrameType.OP_FRAME))
        self.model = model
        self._data = model.createData()
        self._tip = model.getFrameId("t")

    def transform_tip_to_platform(self, angles: Sequence[float] | Floats) -> Floats:
        """Return T_pt (4, 4) for (roll, tilt angle) [rad]."""
        pin.framesForwardKinematics(self.model, self._data, vector(angles, 2, "arm angles"))
        return self._data.oMf[self._tip].homogeneous.copy()

    def jacobian(self, angles: Sequence[float] | Floats) -> Floats:
        """Return the Jacobian (6, 2) from angle rates to the tip twist (linear; angular) with the axes of {p}."""
        frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return pin.computeFrameJacobian(self.model, self._data, vector(angles, 2, "arm angles"), self._tip, frame)

    def gravity_torque(self, angles: Sequence[float] | Floats) -> Floats:
        """Return the torques (2,) [N m] that hold roll and tilt against gravity along -z of {p}."""
        return pin.computeGeneralizedGravity(self.model, self._data, vector(angles, 2, "arm angles")).copy()


def _at(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> pin.SE3:
    return pin.SE3(np.eye(3), np.array([x, y, z]))


def _point_mass(mass: float, com: tuple[float, float, float]) -> pin.Inertia:
    return pin.Inertia(mass, np.array(com), np.zeros((3, 3)))
