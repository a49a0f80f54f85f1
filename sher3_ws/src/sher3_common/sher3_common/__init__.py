"""The words that every package shares.

Errors that carry value, limit and remedy; the doors through which files are read; the CRTK operating state; reasons
to stop with their actions; samples of the topics; stamps and ages; vectors. Nothing here knows ROS or the robot.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_common.errors import FileError as FileError
    from sher3_common.errors import Sher3Error as Sher3Error
    from sher3_common.files.text import dump_yaml as dump_yaml
    from sher3_common.files.text import make_folder as make_folder
    from sher3_common.files.text import parse_json as parse_json
    from sher3_common.files.text import parse_yaml as parse_yaml
    from sher3_common.files.text import read_bytes as read_bytes
    from sher3_common.files.text import read_json as read_json
    from sher3_common.files.text import read_text as read_text
    from sher3_common.files.text import read_yaml as read_yaml
    from sher3_common.operating_state import OperatingState as OperatingState
    from sher3_common.reasons import Action as Action
    from sher3_common.reasons import Reason as Reason

__getattr__, __dir__ = lazy(
    __name__,
    {
        "errors": ("FileError", "Sher3Error"),
        "files.text": (
            "dump_yaml",
            "make_folder",
            "parse_json",
            "parse_yaml",
            "read_bytes",
            "read_json",
            "read_text",
            "read_yaml",
        ),
        "operating_state": ("OperatingState",),
        "reasons": ("Action", "Reason"),
    },
)
