"""Play an excitation into a running graph: enable, go to its start, stream it, one decision per tick.

Plain code: it is told the stamp and what has been heard, and says what to send; `excite_node.py` is its body.
Set-points go out early, each with the stamp of its tick, so that the player's own jitter does not reach the robot.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from sher3_common import Sher3Error
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_description import Robot

from sher3_gap.excitation import Excitation

AHEAD = 0.1
"""Seconds a set-point is sent before its tick."""
SETTLE = 0.6
"""Seconds of rest at the start posture before the excitation."""
PATIENCE = 20.0
"""Seconds to wait for the robot to be enabled and at the start."""
CLOSE = 5e-3
"""Distance from the start, as a share of an axis' travel, at which the robot has arrived."""


class PlayError(Sher3Error):
    """The excitation could not be played: the robot is not enabled, does not arrive, or stopped on the way."""


class Phase(Enum):
    """What the player is doing."""

    ENABLE = "waiting for the robot to be enabled"
    APPROACH = "going to the start"
    SETTLE = "resting at the start"
    PLAY = "playing"
    DONE = "done"


@dataclass
class Heard:
    """What the graph says: operating state, owner of the robot, load-encoder positions (5,)."""

    state: str = ""
    mode: str | None = None
    position: tuple[float, ...] = ()


@dataclass(frozen=True)
class SetPoint:
    """A reference for the tick of its stamp."""

    stamp: int
    position: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass
class Player:
    """One excitation on its way into the graph.

    Attributes:
        phase: what it is doing; `first` and `last`: stamps of the excitation's first and last tick once it plays.
    """

    excitation: Excitation
    robot: Robot
    heard: Heard = field(default_factory=Heard)
    phase: Phase = Phase.ENABLE
    first: int = 0
    last: int = 0
    _since: int = 0
    _sent: int = 0
    _asked: int = 0

    @property
    def start(self) -> tuple[float, ...]:
        """Positions the excitation starts from, (5,)."""
        return tuple(self.excitation.position[0].tolist())

    def tick(self, stamp: int) -> tuple[str | None, bool, list[SetPoint], tuple[float, ...]]:
        """Return what to send at `stamp`: a state command, whether to move to the start, set-points, the tip load (6,).

        Raises:
            PlayError: the robot is not enabled or not there in time, or it stopped while playing.
        """
        self._since = self._since or stamp
        if self.phase in (Phase.ENABLE, Phase.APPROACH) and stamp - self._since > PATIENCE * 1e9:
            heard = self.heard.state or "nothing heard"
            remedy = "see supervisor/status" if self.heard.state else "start `sher3 up` with the same --domain"
            raise PlayError(f"still {self.phase.value}", value=heard, limit=f"{PATIENCE:g} s", remedy=remedy)
        state = self._enable(stamp)
        move = self._approach(stamp)
        points = self._play(stamp)
        return state, move, points, self._load(stamp)

    def _enable(self, stamp: int) -> str | None:
        if self.phase is not Phase.ENABLE:
            return None
        if self.heard.state == OperatingState.ENABLED and self.heard.position:
            self.phase, self._asked = Phase.APPROACH, 0
            return None
        if self.heard.state == OperatingState.FAULT:
            raise PlayError("the robot is in FAULT", remedy="see supervisor/status; send disable, then enable")
        if stamp - self._asked < 1e9:
            return None
        self._asked = stamp
        return StateCommand.ENABLE.value

    def _approach(self, stamp: int) -> bool:
        if self.phase is Phase.SETTLE:
            if stamp - self._since > SETTLE * 1e9:
                self._begin(stamp)
            return False
        if self.phase is not Phase.APPROACH:
            return False
        if self._arrived() and self.heard.mode is None:
            self.phase, self._since = Phase.SETTLE, stamp
            return False
        if self._arrived() or stamp - self._asked < 2e9 or self.heard.mode is not None:
            return False
        self._asked = stamp
        return True

    def _arrived(self) -> bool:
        travel = [a.limits.upper - a.limits.lower for a in self.robot.actuators]
        gaps = zip(self.heard.position, self.start, travel, strict=True)
        return all(abs(q - goal) < CLOSE * t for q, goal, t in gaps)

    def _begin(self, stamp: int) -> None:
        period = round(self.excitation.period * 1e9)
        self.phase, self.first = Phase.PLAY, stamp + round(AHEAD * 1e9 / period) * period
        self.last = self.first + (len(self.excitation.position) - 1) * period

    def _play(self, stamp: int) -> list[SetPoint]:
        if self.phase is not Phase.PLAY:
            return []
        period = round(self.excitation.period * 1e9)
        if stamp > self.last:
            self.phase = Phase.DONE
            return []
        if self.heard.state != OperatingState.ENABLED:
            raise PlayError("the robot stopped while playing", value=self.heard.state, remedy="see supervisor/status")
        until = min(len(self.excitation.position), (stamp + round(AHEAD * 1e9) - self.first) // period + 1)
        made = [self._point(k, self.first + k * period) for k in range(self._sent, max(until, self._sent))]
        self._sent += len(made)
        return made

    def _point(self, k: int, stamp: int) -> SetPoint:
        e = self.excitation
        return SetPoint(stamp, tuple(e.position[k].tolist()), tuple(e.velocity[k].tolist()))

    def _load(self, stamp: int) -> tuple[float, ...]:
        """Return the tip load in {b} of the tick that follows `stamp`, which the plant integrates to."""
        if self.phase is not Phase.PLAY or not self.excitation.loads or stamp < self.first:
            return (0.0,) * 6
        wrench = self._wrench
        k = (stamp - self.first) // round(self.excitation.period * 1e9)
        return tuple(wrench[min(int(k), len(wrench) - 1)].tolist())

    @property
    def _wrench(self) -> np.ndarray:
        if not hasattr(self, "_wrench_table"):
            self._wrench_table = self.excitation.contact_wrench()
        return self._wrench_table
