"""Kinematics of the SHER 3.0: delta stage, tilt linkage, whole robot, inverse velocity, deflection."""

from .delta import Delta as Delta
from .errors import BadInput as BadInput
from .errors import OutsideLimits as OutsideLimits
from .errors import Singular as Singular
from .errors import Unreachable as Unreachable
from .inverse_velocity import InverseVelocity as InverseVelocity
from .inverse_velocity import LimitedVelocity as LimitedVelocity
from .kernel_parameters import KernelParameters as KernelParameters
from .kernel_parameters import kernel_parameters as kernel_parameters
from .robot_kinematics import RobotKinematics as RobotKinematics
from .robot_kinematics import SingularityDistance as SingularityDistance
from .tilt_linkage import TiltLinkage as TiltLinkage
