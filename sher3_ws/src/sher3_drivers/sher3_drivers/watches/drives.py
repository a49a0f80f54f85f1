"""What the host knows of each drive, and what it objects to: pure bookkeeping with time as an argument (ns)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from sher3_common.reasons import Reason

from sher3_drivers.canopen.cia402 import DriveState, Goal, StatusBit, decode_status
from sher3_drivers.canopen.emcy import Emergency, decode_emergency, reason_of
from sher3_drivers.canopen.objects import OPERATIONAL
from sher3_drivers.errors import FrameError, UnknownStatusword
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.watches.trips import Trip

_SETTLED = {Goal.ENABLED: DriveState.OPERATION_ENABLED, Goal.DISABLED: DriveState.SWITCH_ON_DISABLED}
FAULTY = (DriveState.FAULT, DriveState.FAULT_REACTION_ACTIVE)
"""States of a drive that has found a fault."""
_MEANINGS = (
    (StatusBit.REMOTE, 1, "does not take commands from the bus (bit 9, remote)"),
    (StatusBit.VOLTAGE_ENABLED, 1, "has no supply for its motor (bit 4, voltage enabled)"),
    (StatusBit.INTERNAL_LIMIT, 0, "limits its motion by itself (bit 11, internal limit active)"),
    (StatusBit.FOLLOWS_COMMAND, 1, "does not follow its command (bit 12)"),
)
"""Bits of a statusword, what they are in a drive that does as it is told, and what they say when they are not."""
_ALWAYS = (StatusBit.REMOTE,)
"""Bits that mean the same in every state of a drive."""
_BITS = sum(1 << bit for bit, _, _ in _MEANINGS)
_OBEYS = sum(right << bit for bit, right, _ in _MEANINGS)
_KEPT = 100
"""Emergency messages kept per drive: enough for the story of a fault, little enough for a drive that repeats itself."""
_LOOK_NS = 5_000_000
"""Time between two looks, ns: little beside the limits, which are 200 ms and more; a look in every tick is waste."""
_NMT_STATE = 0x7F
"""Bits of a heartbeat that hold the NMT state (CiA 301, error control protocols); bit 7 is reserved."""


@dataclass
class DriveHealth:
    """What is known of one drive.

    Attributes:
        name: actuator.
        word: newest statusword, None before the first.
        state: CiA 402 state it encodes.
        state_since: when that state began, ns.
        heard_at: newest heartbeat, ns; None before the first.
        missing: consecutive ticks with a TPDO missing.
        missing_total: number of all ticks with a TPDO missing.
        emergencies: every emergency message but "error reset", newest last, at most 100.
        active: emergency messages since the last "error reset".
        restarted: it said that it is not OPERATIONAL, so it has lost its configuration or was stopped.
        silent: its TPDOs stay away for as long as is allowed.
        resetting: a recovery holds `fault reset` until the drive leaves FAULT.
        doubtful: statuswords in a row that say that it does not do as it is told.
        setup_due: a recovery has still to configure it again; until then its silence is no news.
    """

    name: str
    word: int | None = None
    state: DriveState | None = None
    state_since: int = 0
    heard_at: int | None = None
    missing: int = 0
    missing_total: int = 0
    emergencies: list[Emergency] = field(default_factory=list)
    active: list[Emergency] = field(default_factory=list)
    restarted: bool = False
    silent: bool = False
    resetting: bool = False
    doubtful: int = 0
    setup_due: bool = False

    def recover(self) -> None:
        """Begin a recovery: a fault is reset, and a drive that restarted or does not answer is configured again."""
        self.resetting = self.state in FAULTY
        self.setup_due = self.restarted or self.silent

    def end_recovery(self) -> None:
        """Give the recovery up: the robot stops, and the next recovery begins anew."""
        self.resetting = self.setup_due = False

    def set_up(self, now: int) -> None:
        """Take note that the drive restarted, was configured and is OPERATIONAL; its statusword has still to come."""
        self.word, self.state, self.state_since, self.heard_at, self.missing = None, None, now, now, 0
        self.restarted = self.silent = False
        self.active.clear()
        self.end_recovery()

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
            self.resetting = self.resetting and state in FAULTY
        return None

    @property
    def warns(self) -> bool:
        """Whether its statusword bears a warning."""
        return self.word is not None and bool(self.word >> StatusBit.WARNING & 1)

    def objection(self, following: bool, limit: int) -> Trip | None:
        """Object to a drive that is to be enabled and says, `limit` ticks in a row, that it does not do as it is told.

        `following`: every drive is in OPERATION ENABLED, so the bits of that state mean something.
        """
        word = self.word
        if word is None or word & _BITS == _OBEYS or self.setup_due:
            self.doubtful = 0
            return None
        says = [text for bit, right, text in _MEANINGS if word >> bit & 1 != right and (following or bit in _ALWAYS)]
        self.doubtful = self.doubtful + 1 if says else 0
        if self.doubtful < limit:
            return None
        return Trip(Reason.DRIVE_UNWILLING, f"{self.name}: {' and '.join(says)}", self.doubtful, limit, "ticks")

    def on_heartbeat(self, data: bytes, now: int) -> Trip | None:
        """Take a heartbeat; object when the drive is not OPERATIONAL."""
        known, self.heard_at = self.heard_at, now
        state = data[0] & _NMT_STATE if data else -1
        if state == OPERATIONAL or known is None:
            return None
        self.restarted = True
        if self.setup_due:
            return None
        text = f"{self.name}: NMT state {state}, not OPERATIONAL (5); the drive restarted or was stopped"
        return Trip(Reason.DRIVE_RESTARTED, text, state, OPERATIONAL, "NMT state")

    def on_emergency(self, data: bytes) -> Trip | None:
        """Take an emergency message (EMCY); object unless it says that an error is gone."""
        try:
            emergency = decode_emergency(data)
        except FrameError as error:
            return Trip(Reason.DRIVE_EMERGENCY, f"{self.name}: {error}")
        if emergency.is_reset:
            self.active.clear()
            return None
        self.active.append(emergency)
        self.emergencies = [*self.emergencies[1 - _KEPT :], emergency]
        return Trip(reason_of(emergency.code), f"{self.name}: {emergency}", emergency.code, unit="EMCY code")

    def on_tick(self, is_missing: bool, limit: int) -> Trip | None:
        """Count a tick's TPDOs; object when one stayed away `limit` times in a row."""
        self.missing = self.missing + 1 if is_missing else 0
        self.missing_total += is_missing
        self.silent = self.missing >= limit
        if not self.silent or self.setup_due:
            return None
        text = f"{self.name}: no TPDO for {self.missing} ticks (limit {limit})"
        return Trip(Reason.DRIVE_SILENT, text, self.missing, limit, "ticks")

    def silence(self, now: int, since: int, limit: float) -> Trip | None:
        """Object to a heartbeat older than `limit` s; before the first one the time counts from `since` (ns)."""
        age = (now - (self.heard_at or since)) * 1e-9
        if age <= limit or self.setup_due:
            return None
        text = f"{self.name}: no heartbeat for {age:.3f} s ({limit:g} s)"
        return Trip(Reason.DRIVE_SILENT, text, age, limit, "s")

    def stuck(self, goal: Goal, now: int, since: int, limit: float) -> Trip | None:
        """Object to a drive that does not reach its goal within `limit` s, or does not leave FAULT on its reset.

        A drive whose first statusword has not come yet has no state; its time counts from `since` (ns).
        """
        wanted = _SETTLED.get(goal)
        time = (now - (self.state_since or since)) * 1e-9
        known = self.setup_due or (self.state in FAULTY and not self.resetting)
        if wanted is None or self.state is wanted or known or time <= limit:
            return None
        name = self.state.name if self.state else "an unknown state"
        text = f"{self.name}: stays in {name} for {time:.3f} s instead of going to {wanted.name}"
        return Trip(Reason.DRIVE_STUCK, text, time, limit, "s")

    def fallen(self, running: bool) -> Trip | None:
        """Object to a drive that stops on its way to OPERATION ENABLED, or leaves that state once it is `running`."""
        down = self.state in (*FAULTY, DriveState.QUICK_STOP_ACTIVE)
        if (
            self.state is None
            or self.resetting
            or not (down or (running and self.state is not DriveState.OPERATION_ENABLED))
        ):
            return None
        return Trip(Reason.DRIVE_FELL, f"{self.name}: went to {self.state.name}")

    def faulty(self) -> Trip:
        """Return the objection to a fault of a drive that was at rest; its emergency message may have been lost."""
        return Trip(Reason.DRIVE_FAULT, f"{self.name}: in FAULT while it was to be without power")


class DrivesWatch:
    """Watches drives with long limits: heartbeats and CiA 402 transitions."""

    def __init__(self, health: Sequence[DriveHealth], settings: MotorDriverSettings) -> None:
        self._health, self._settings = tuple(health), settings
        self._started_at = self._next_look = 0

    def begin(self, now: int) -> None:
        """Note the first tick: the silence of a drive that was never heard counts from there."""
        self._started_at = self._started_at or now

    def is_due(self, now: int) -> bool:
        """Whether it is time for the next look."""
        return now >= self._next_look

    def check(self, goal: Goal, now: int) -> list[Trip]:
        """Return what is to be said against the drives on their way to `goal`: a look."""
        self._next_look = now + _LOOK_NS
        since, settings = self._started_at, self._settings
        found = []
        for drive in self._health:
            found.append(drive.silence(now, since, settings.drive_heartbeat_limit))
            found.append(drive.stuck(goal, now, since, settings.transition_limit))
        return [trip for trip in found if trip is not None]
