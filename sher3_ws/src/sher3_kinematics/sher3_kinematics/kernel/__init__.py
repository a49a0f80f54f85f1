"""The kinematics as compiled functions, callable from Python and from other compiled code.

The first argument is always the flat tuple of parameters, `KernelParameters`. Where no solution exists the functions
return NaN; the classes of `sher3_kinematics` raise errors instead.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_kinematics.kernel.parameters import KernelParameters as KernelParameters
    from sher3_kinematics.kernel.parameters import kernel_parameters as kernel_parameters
    from sher3_kinematics.kernel.robot import delta_forward as delta_forward
    from sher3_kinematics.kernel.robot import delta_inverse as delta_inverse
    from sher3_kinematics.kernel.robot import delta_jacobian as delta_jacobian
    from sher3_kinematics.kernel.robot import delta_jacobian_into as delta_jacobian_into
    from sher3_kinematics.kernel.robot import gravity_load as gravity_load
    from sher3_kinematics.kernel.robot import gravity_load_into as gravity_load_into
    from sher3_kinematics.kernel.robot import pose_inverse as pose_inverse
    from sher3_kinematics.kernel.robot import pose_inverse_into as pose_inverse_into
    from sher3_kinematics.kernel.robot import tip_jacobian as tip_jacobian
    from sher3_kinematics.kernel.robot import tip_jacobian_into as tip_jacobian_into
    from sher3_kinematics.kernel.robot import tip_pose as tip_pose
    from sher3_kinematics.kernel.robot import tip_pose_into as tip_pose_into
    from sher3_kinematics.kernel.robot import tip_position as tip_position
    from sher3_kinematics.kernel.tilt import tilt_angle as tilt_angle
    from sher3_kinematics.kernel.tilt import tilt_ratio as tilt_ratio
    from sher3_kinematics.kernel.tilt import tilt_sine_cosine as tilt_sine_cosine
    from sher3_kinematics.kernel.tilt import tilt_slider as tilt_slider

__getattr__, __dir__ = lazy(
    __name__,
    {
        "parameters": ("KernelParameters", "kernel_parameters"),
        "robot": (
            "delta_forward",
            "delta_inverse",
            "delta_jacobian",
            "delta_jacobian_into",
            "gravity_load",
            "gravity_load_into",
            "pose_inverse",
            "pose_inverse_into",
            "tip_jacobian",
            "tip_jacobian_into",
            "tip_pose",
            "tip_pose_into",
            "tip_position",
        ),
        "tilt": ("tilt_angle", "tilt_ratio", "tilt_sine_cosine", "tilt_slider"),
    },
)
