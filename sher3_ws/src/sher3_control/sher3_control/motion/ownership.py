"""One owner at a time: which motion mode commands the robot, and why another mode is refused."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sher3_common.stamps import seconds

from sher3_control.errors import OwnerConflict


class Mode(str, Enum):
    """Motion modes; the value is the CRTK name of the command."""

    COOPERATIVE = "cooperative"
    SERVO_CV = "servo_cv"
    SERVO_JV = "servo_jv"
    SERVO_JP = "servo_jp"
    SERVO_CP = "servo_cp"
    MOVE_JP = "move_jp"
    MOVE_CP = "move_cp"


MODE_CODES: dict[Mode | None, int] = {None: 0, **{mode: k for k, mode in enumerate(Mode, start=1)}}
"""Numbers of the modes in recordings, which never change; 0 stands for nobody."""


@dataclass
class Ownership:
    """Who owns the robot; at first nobody.

    Attributes:
        owner: the mode, or None for nobody.
        since: time of the last change of owner [ns].
    """

    owner: Mode | None = None
    since: int = 0

    def require_free(self, mode: Mode, publishers: int = 1) -> None:
        """Refuse `mode` unless it owns the robot already or nobody does.

        Raises:
            OwnerConflict: another mode owns the robot, or the command topic has `publishers` > 1.
        """
        if publishers > 1:
            why = f"command/{mode.value} has several publishers"
            remedy = "stop all publishers of the topic but one"
            raise OwnerConflict(mode.value, why, owner="unclear", value=publishers, limit=1, remedy=remedy)
        if self.owner is not None and self.owner != mode:
            why = f"{self.owner.value} owns the robot since {seconds(self.since):.3f} s"
            remedy = "wait until it ends, or send disable"
            raise OwnerConflict(mode.value, why, owner=self.owner.value, remedy=remedy)

    def claim(self, mode: Mode, now: int) -> None:
        """Make `mode` the owner at the time `now` [ns]; raises OwnerConflict as `require_free` does."""
        self.require_free(mode)
        if self.owner is not mode:
            self.owner, self.since = mode, now

    def release(self, now: int) -> None:
        """Leave the robot to nobody at the time `now` [ns]."""
        if self.owner is not None:
            self.owner, self.since = None, now
