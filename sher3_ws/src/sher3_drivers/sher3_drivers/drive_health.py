"""What the host knows of one drive, and what it objects to: pure bookkeeping with time as an argument (ns)."""

from __future__ import annotations

from dataclasses import dataclass, field

from sher3_description.reasons import Reason

from .cia402 import Goal, State, decode_status
from .emcy import Emergency, decode_emergency, reason_of
from .errors import FrameError, UnknownStatusword
from .settings import MotorDriverSettings
from .trips import Trip

BOOT_UP = 0
OPERATIONAL = 5
_SETTLED = {Goal.ENABLED: State.OPERATION_ENABLED, Goal.DISABLED: State.SWITCH_ON_DISABLED}
_FAULTY = (State.FAULT, State.FAULT_REACTION_ACTIVE)


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

    def on_statusword(self, word: int, now: int) -> Trip | None:
        """Take a statusword; object when it encodes no state."""
        self.word = word
        try:
            state = decode_status(word)
        except UnknownStatusword as error:
            self.state = None
            return Trip(Reason.DRIVE_STATUSWORD, f"{self.name}: {error}", word, unit="statusword")
        if state is not self.state:
            self.state, self.state_since = state, now
        return None

    def on_heartbeat(self, data: bytes, now: int) -> Trip | None:
        """Take a heartbeat; object when the drive is not OPERATIONAL."""
        known, self.heard_at = self.heard_at, now
        state = data[0] & 0x7F if data else -1
        if state == OPERATIONAL or known is None:
            return None
        text = f"{self.name}: NMT state {state}, not OPERATIONAL (5); the drive restarted or was stopped"
        return Trip(Reason.DRIVE_RESTARTED, text, state, OPERATIONAL, "NMT state")

    def on_emergency(self, data: bytes) -> Trip | None:
        """Take an EMCY; object unless it says that an error is gone."""
        try:
            emergency = decode_emergency(data)
        except FrameError as error:
            return Trip(Reason.DRIVE_EMERGENCY, f"{self.name}: {error}")
        if emergency.is_reset:
            self.active.clear()
            return None
        self.active.append(emergency)
        self.emergencies = [*self.emergencies[-99:], emergency]
        return Trip(reason_of(emergency.code), f"{self.name}: {emergency}", emergency.code, unit="EMCY code")

    def on_tick(self, is_missing: bool, limit: int) -> Trip | None:
        """Count a tick's TPDOs; object when one stayed away `limit` times in a row."""
        self.missing = self.missing + 1 if is_missing else 0
        self.missing_total += is_missing
        if self.missing < limit:
            return None
        text = f"{self.name}: no TPDO for {self.missing} ticks (limit {limit})"
        return Trip(Reason.DRIVE_SILENT, text, self.missing, limit, "ticks")

    def silence(self, now: int, since: int, limit: float) -> Trip | None:
        """Object to a heartbeat older than `limit` [s]; before the first one the time counts from `since`."""
        age = (now - (self.heard_at or since)) * 1e-9
        if age <= limit:
            return None
        text = f"{self.name}: no heartbeat for {age:.3f} s ({limit:g} s)"
        return Trip(Reason.DRIVE_SILENT, text, age, limit, "s")

    def stuck(self, goal: Goal, now: int, since: int, limit: float) -> Trip | None:
        """Object to a drive that does not get where it should within `limit` [s].

        A drive whose first statusword is still on its way has no state yet, and no time of its own: `since` counts.
        """
        wanted = _SETTLED.get(goal)
        time = (now - (self.state_since or since)) * 1e-9
        if wanted is None or self.state is wanted or self.state in _FAULTY or time <= limit:
            return None
        name = self.state.name if self.state else "an unknown state"
        text = f"{self.name}: stays in {name} for {time:.3f} s instead of going to {wanted.name}"
        return Trip(Reason.DRIVE_STUCK, text, time, limit, "s")

    def fallen(self, running: bool) -> Trip | None:
        """Object to a drive that fell back from the way to OPERATION ENABLED, or from there once it is `running`."""
        down = self.state in (*_FAULTY, State.QUICK_STOP_ACTIVE)
        if self.state is None or not (down or (running and self.state is not State.OPERATION_ENABLED)):
            return None
        return Trip(Reason.DRIVE_FELL, f"{self.name}: went to {self.state.name}")


def watch_drives(
    health: list[DriveHealth], goal: Goal, now: int, since: int, settings: MotorDriverSettings
) -> list[Trip]:
    """Return what is to be said against drives with long limits: heartbeats and transitions."""
    found = []
    for drive in health:
        found.append(drive.silence(now, since, settings.drive_heartbeat_limit))
        found.append(drive.stuck(goal, now, since, settings.transition_limit))
    return [trip for trip in found if trip is not None]
