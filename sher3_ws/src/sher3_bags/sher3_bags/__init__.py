"""Record, read, write, replay and analyse bags of the SHER 3.0.

The main object is the run: one column of stamps and one of values for each topic, all in seconds and SI units. A bag
holds a run as an MCAP file; a case is a folder with the runs of one experiment and the robot they were recorded on.
`recording` and `playback` join runs with the ROS graph, `figures` computes what a run tells, `mcap` and `codec` know
the bytes.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_bags.case import Case as Case
    from sher3_bags.case import read_case as read_case
    from sher3_bags.case import write_case as write_case
    from sher3_bags.errors import BagError as BagError
    from sher3_bags.reading import read_run as read_run
    from sher3_bags.recording.recorder import Recorder as Recorder
    from sher3_bags.recovery import recover as recover
    from sher3_bags.run import Run as Run
    from sher3_bags.run import RunMetadata as RunMetadata
    from sher3_bags.run import Stream as Stream
    from sher3_bags.run import check_run as check_run
    from sher3_bags.run import stream as stream
    from sher3_bags.writing import write_run as write_run

__getattr__, __dir__ = lazy(
    __name__,
    {
        "case": ("Case", "read_case", "write_case"),
        "errors": ("BagError",),
        "recovery": ("recover",),
        "reading": ("read_run",),
        "recording.recorder": ("Recorder",),
        "run": ("Run", "RunMetadata", "Stream", "check_run", "stream"),
        "writing": ("write_run",),
    },
)
