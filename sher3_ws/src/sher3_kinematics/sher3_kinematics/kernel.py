"""Compiled scalar kernels, callable from Python and from other compiled code; the first argument is the parameters."""

from .kernel_delta import compiled as compiled
from .kernel_parameters import GRAVITY as GRAVITY
from .kernel_parameters import KernelParameters as KernelParameters
from .kernel_parameters import kernel_parameters as kernel_parameters
from .kernel_robot import delta_forward as delta_forward
from .kernel_robot import delta_inverse as delta_inverse
from .kernel_robot import delta_jacobian as delta_jacobian
from .kernel_robot import delta_jacobian_into as delta_jacobian_into
from .kernel_robot import gravity_load as gravity_load
from .kernel_robot import gravity_load_into as gravity_load_into
from .kernel_robot import pose_inverse as pose_inverse
from .kernel_robot import pose_inverse_into as pose_inverse_into
from .kernel_robot import tip_jacobian as tip_jacobian
from .kernel_robot import tip_jacobian_into as tip_jacobian_into
from .kernel_robot import tip_pose as tip_pose
from .kernel_robot import tip_pose_into as tip_pose_into
from .kernel_robot import tip_position as tip_position
from .kernel_tilt import tilt_angle as tilt_angle
from .kernel_tilt import tilt_ratio as tilt_ratio
from .kernel_tilt import tilt_sine_cosine as tilt_sine_cosine
from .kernel_tilt import tilt_slider as tilt_slider
