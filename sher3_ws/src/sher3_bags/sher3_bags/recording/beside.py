"""What a recording holds beside the streams: the robot for viewers, statuses and ticks as typed messages."""

from __future__ import annotations

from sher3_description import Robot

from sher3_bags.codec.cdr import TEXT_START
from sher3_bags.recording.made import Made
from sher3_bags.recording.robot_frames import SOURCE, RobotFrames
from sher3_bags.recording.typed_status import SOURCES, TypedStatuses
from sher3_bags.recording.typed_tick import TICKS, typed_tick

FOLLOWED = frozenset((SOURCE, *SOURCES, *TICKS))
"""Topics from which something follows."""


class Beside:
    """Makes what follows from the messages of a robot."""

    def __init__(self, robot: Robot) -> None:
        self._frames, self._statuses = RobotFrames(robot), TypedStatuses()

    def fixed(self, stamp: int) -> list[Made]:
        """Return what never changes; stamp in ns."""
        return self._frames.fixed(stamp)

    def follow(self, topic: str, data: bytes, now: int) -> list[Made]:
        """Return what follows from a message (CDR) of one of `FOLLOWED` at `now` [ns]; nothing from garbage."""
        if topic == SOURCE:
            return self._frames.follow(data)
        text = data[TEXT_START:].rstrip(b"\0").decode("utf-8", "replace")
        return typed_tick(topic, text) if topic in TICKS else self._statuses.follow(topic, text, now)
