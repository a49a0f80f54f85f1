"""Parameters, topic table, errors and URDF of the SHER 3.0."""

from .equipment import ACTUATORS as ACTUATORS
from .equipment import Actuator as Actuator
from .equipment import Admittance as Admittance
from .equipment import Drive as Drive
from .equipment import ForceSensor as ForceSensor
from .equipment import Limits as Limits
from .equipment import Tracker as Tracker
from .errors import FileError as FileError
from .errors import Sher3Error as Sher3Error
from .files import parse_yaml as parse_yaml
from .files import read_text as read_text
from .files import read_yaml as read_yaml
from .invalid_robot import InvalidRobot as InvalidRobot
from .mechanism import ArmParameters as ArmParameters
from .mechanism import DeltaParameters as DeltaParameters
from .mechanism import TiltLinkageParameters as TiltLinkageParameters
from .robot import NOMINAL_ROBOT as NOMINAL_ROBOT
from .robot import Robot as Robot
from .robot import load_robot as load_robot
from .topics import NAMESPACE as NAMESPACE
from .topics import TOPICS as TOPICS
from .topics import Qos as Qos
from .topics import Topic as Topic
