"""Kinematics of the SHER 3.0.

The main object is `RobotKinematics`: tip pose from actuator positions and back, Jacobian, gravity loads. It stands on
`Delta` (three sliders carry a platform), `TiltLinkage` (a slider tilts the tool) and the arm between them.
`InverseVelocity` turns a twist of the tip into actuator velocities within all limits. `deflection` and `tip_deflection`
bend the links. `kernel` is the same mathematics for compiled code.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_kinematics.delta import Delta as Delta
    from sher3_kinematics.errors import BadInput as BadInput
    from sher3_kinematics.errors import OutsideLimits as OutsideLimits
    from sher3_kinematics.errors import Singular as Singular
    from sher3_kinematics.errors import Unreachable as Unreachable
    from sher3_kinematics.inverse_velocity import InverseVelocity as InverseVelocity
    from sher3_kinematics.inverse_velocity import LimitedVelocity as LimitedVelocity
    from sher3_kinematics.kernel.parameters import KernelParameters as KernelParameters
    from sher3_kinematics.kernel.parameters import kernel_parameters as kernel_parameters
    from sher3_kinematics.robot_kinematics import RobotKinematics as RobotKinematics
    from sher3_kinematics.tilt_linkage import TiltLinkage as TiltLinkage

__getattr__, __dir__ = lazy(
    __name__,
    {
        "delta": ("Delta",),
        "errors": ("BadInput", "OutsideLimits", "Singular", "Unreachable"),
        "inverse_velocity": ("InverseVelocity", "LimitedVelocity"),
        "kernel.parameters": ("KernelParameters", "kernel_parameters"),
        "robot_kinematics": ("RobotKinematics",),
        "tilt_linkage": ("TiltLinkage",),
    },
)
