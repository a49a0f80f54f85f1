"""Admittance law, motion modes, limits and supervisor of the SHER 3.0."""

from .admittance import LawInput as LawInput
from .admittance import LawOutput as LawOutput
from .admittance import LawParameters as LawParameters
from .admittance import LawState as LawState
from .admittance import initial_state as initial_state
from .admittance import step as step
from .axis_lock import AxisLock as AxisLock
from .law_parameters import law_parameters as law_parameters
from .position_controller import position_command as position_command
from .position_controller import position_commands as position_commands
from .position_controller import position_law as position_law
from .reasons import Reason as Reason
from .settings import ControlSettings as ControlSettings
