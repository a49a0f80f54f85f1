"""Admittance law, motion modes, limits and supervisor of the SHER 3.0.

The main object is the cooperative law: `step(state, input, parameters)` turns one wrench and pedal sample into one
tip twist, without clocks, files or ROS. `motion` turns twists and commands of the user into actuator velocities,
`supervision` decides whether the robot may move at all, and `nodes` puts the three on the ROS graph.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_control.law.admittance import LawInput as LawInput
    from sher3_control.law.admittance import LawOutput as LawOutput
    from sher3_control.law.admittance import LawParameters as LawParameters
    from sher3_control.law.admittance import LawState as LawState
    from sher3_control.law.admittance import initial_state as initial_state
    from sher3_control.law.admittance import step as step
    from sher3_control.law.axis_lock import AxisLock as AxisLock
    from sher3_control.law.parameters import law_parameters as law_parameters
    from sher3_control.law.position_controller import position_commands as position_commands
    from sher3_control.motion.controller import MotionController as MotionController
    from sher3_control.settings import ControlSettings as ControlSettings
    from sher3_control.supervision.supervisor import Supervisor as Supervisor

__getattr__, __dir__ = lazy(
    __name__,
    {
        "law.admittance": ("LawInput", "LawOutput", "LawParameters", "LawState", "initial_state", "step"),
        "law.axis_lock": ("AxisLock",),
        "law.parameters": ("law_parameters",),
        "law.position_controller": ("position_commands",),
        "motion.controller": ("MotionController",),
        "settings": ("ControlSettings",),
        "supervision.supervisor": ("Supervisor",),
    },
)
