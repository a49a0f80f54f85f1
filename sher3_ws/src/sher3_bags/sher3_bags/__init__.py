"""Record, read, write, replay and analyse bags of the SHER 3.0."""

from .case import Case as Case
from .case import read_case as read_case
from .case import write_case as write_case
from .errors import BagError as BagError
from .errors import CaseError as CaseError
from .errors import DamagedBagError as DamagedBagError
from .errors import ForeignBagError as ForeignBagError
from .errors import LimitError as LimitError
from .errors import MalformedMessageError as MalformedMessageError
from .errors import MissingTopicError as MissingTopicError
from .errors import NotFiniteError as NotFiniteError
from .errors import StampError as StampError
from .errors import TopicError as TopicError
from .errors import WrongTypeError as WrongTypeError
from .reading import read_run as read_run
from .recorder import Recorder as Recorder
from .recovery import Recovery as Recovery
from .recovery import recover as recover
from .run import Run as Run
from .run import RunMetadata as RunMetadata
from .run import Stream as Stream
from .run import check_run as check_run
from .run import stream as stream
from .writing import write_run as write_run
