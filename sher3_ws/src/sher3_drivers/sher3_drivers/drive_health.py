"""What the host knows of one drive, and why the robot stopped: pure bookkeeping with time as an argument (ns)."""

from __future__ import annotations

from dataclasses import dataclass, field

from .cia402 import State, decode_status
from .emcy import Emergency, decode_emergency
from .errors import FrameError, UnknownStatusword

BOOT_UP = 0
OPERATIONAL = 5


@dataclass
class DriveHealth:
    """Running state of one drive.

    Attributes:
        name: actuator.
        word: newest statusword, None before the first.
        state: CiA 402 state it encodes.
        state_since: when that state began, ns.
        heard_at: newest heartbeat, ns; None before the first.
        missing: consecutive ticks with a TPDO missing.
        missing_total: all of them.
        emergencies: every EMCY with a code, newest last, at most 100.
        active: codes since the last "error reset".
    """

    name: str
    word: int | None = None
    state: State | None = None
    state_since: int = 0
    heard_at: int | None = None
    missing: int = 0
    missing_total: int = 0
    emergencies: list[Emergency] = field(default_factory=list)
    active: list[Emergency] = field(default_factory=list)

    def on_statusword(self, word: int, now: int) -> str | None:
        """Take a statusword; return a reason to stop when it encodes no state."""
        self.word = word
        try:
            state = decode_status(word)
        except UnknownStatusword as error:
            self.state = None
            return f"{self.name}: {error}"
        if state is not self.state:
            self.state, self.state_since = state, now
        return None

    def on_heartbeat(self, data: bytes, now: int) -> str | None:
        """Take a heartbeat; return a reason to stop when the drive is not OPERATIONAL."""
        known, self.heard_at = self.heard_at, now
        state = data[0] & 0x7F if data else -1
        if state == OPERATIONAL or known is None:
            return None
        return f"{self.name}: NMT state {state}, not OPERATIONAL (5); the drive restarted or was stopped"

    def on_emergency(self, data: bytes) -> str | None:
        """Take an EMCY; return a reason to stop unless it says that an error is gone."""
        try:
            emergency = decode_emergency(data)
        except FrameError as error:
            return f"{self.name}: {error}"
        if emergency.is_reset:
            self.active.clear()
            return None
        self.active.append(emergency)
        self.emergencies = [*self.emergencies[-99:], emergency]
        return f"{self.name}: {emergency}"

    def on_tick(self, is_missing: bool) -> None:
        """Count a tick's TPDOs."""
        self.missing = self.missing + 1 if is_missing else 0
        self.missing_total += is_missing


@dataclass
class StopLog:
    """Why the driver stopped: the first reason is kept, later ones are counted."""

    reason: str | None = None
    since: int = 0
    later: int = 0

    def add(self, reason: str, now: int) -> bool:
        """Note a reason; True when it is the first."""
        if self.reason is None:
            self.reason, self.since = reason, now
            return True
        self.later += 1
        return False

    def clear(self) -> None:
        """Forget everything."""
        self.reason, self.since, self.later = None, 0, 0
