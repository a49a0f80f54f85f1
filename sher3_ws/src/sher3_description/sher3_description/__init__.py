"""What the SHER 3.0 is: its numbers, its topics, its URDF.

The main object is `Robot`, the validated content of `robot.yaml`; `load_robot()` gives the nominal one. `TOPICS` is the
table of everything that the graph publishes, with types, frames and quality of service.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_description.actuators import ACTUATORS as ACTUATORS
    from sher3_description.equipment import Actuator as Actuator
    from sher3_description.equipment import ForceSensor as ForceSensor
    from sher3_description.invalid_robot import InvalidRobot as InvalidRobot
    from sher3_description.robot import NOMINAL_ROBOT as NOMINAL_ROBOT
    from sher3_description.robot import Robot as Robot
    from sher3_description.robot import load_robot as load_robot
    from sher3_description.tolerances import Tolerances as Tolerances
    from sher3_description.topics import NAMESPACE as NAMESPACE
    from sher3_description.topics import TOPICS as TOPICS
    from sher3_description.topics import Qos as Qos
    from sher3_description.topics import Topic as Topic

__getattr__, __dir__ = lazy(
    __name__,
    {
        "actuators": ("ACTUATORS",),
        "equipment": ("Actuator", "ForceSensor"),
        "invalid_robot": ("InvalidRobot",),
        "robot": ("NOMINAL_ROBOT", "Robot", "load_robot"),
        "tolerances": ("Tolerances",),
        "topics": ("NAMESPACE", "Qos", "TOPICS", "Topic"),
    },
)
