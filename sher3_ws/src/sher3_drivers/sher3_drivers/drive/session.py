"""Where the five drives are being taken, why they were stopped, and how they come back.

Pure bookkeeping with time as an argument (ns): it says which controlword every drive gets next and sends nothing.
The rules are those of CiA 402-2 (`canopen.cia402`) with two restrictions. A stop is left by `reset` alone, and a reset
leads to disabled drives, never straight back to enabled ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sher3_common.reasons import Action

from sher3_drivers.canopen.cia402 import Controlword, DriveState, Goal, next_command
from sher3_drivers.canopen.tpdo import Invalid
from sher3_drivers.errors import CommandRefused
from sher3_drivers.watches.drives import FAULTY, DriveHealth
from sher3_drivers.watches.trips import StopLog, Trip

_POWERED = (DriveState.OPERATION_ENABLED, DriveState.QUICK_STOP_ACTIVE, DriveState.FAULT_REACTION_ACTIVE)
"""States in which a drive drives its motor: it follows commands, or brakes and holds."""


class DriveSession:
    """The session with the drives: its goal, its stop and its recovery.

    Attributes:
        drives: what is known of every drive, in the order of ACTUATORS.
        goal: where the drives are being taken.
        stop: why the driver stopped the robot, if it did.
        all_enabled: whether every drive said at its newest statusword that it is in OPERATION ENABLED.
        cut: numbers of the drives that lose their power at once, since they do not do what they are told.
    """

    def __init__(self, drives: Sequence[DriveHealth], report_limit: int = 3, status_limit: int = 3) -> None:
        self._report_limit, self._status_limit = report_limit, status_limit
        self.drives = tuple(drives)
        self.goal = Goal.DISABLED
        self.stop = StopLog()
        self.all_enabled = False
        self.cut: set[int] = set()
        self._judged_words: list[int | None] = []

    @property
    def enabled(self) -> bool:
        """Whether every drive follows velocity commands."""
        return self.goal is Goal.ENABLED and self.all_enabled

    @property
    def needs_reset(self) -> bool:
        """Whether there is a stop to reset, or a drive in FAULT."""
        return self.stop.first is not None or any(drive.state is DriveState.FAULT for drive in self.drives)

    @property
    def setup_due(self) -> bool:
        """Whether a recovery has still to configure a drive again."""
        return any([drive.setup_due for drive in self.drives])

    @property
    def heading(self) -> Goal:
        """Where the drives are being taken now: no drive gets power before the last one has recovered."""
        recovering = self.setup_due or any(drive.resetting for drive in self.drives)
        return Goal.DISABLED if recovering else self.goal

    @property
    def may_set_up(self) -> bool:
        """Whether that can be done now: no drive that answers has power, so none can be moving on its own ramp."""
        return self.setup_due and not any(drive.state in _POWERED and not drive.setup_due for drive in self.drives)

    def enable(self, now: int) -> bool:
        """Aim at OPERATION ENABLED; return False when that is the goal already.

        Raises:
            CommandRefused: a stop has not been reset, or a drive is in FAULT without being reset.
        """
        if self.stop.first is not None:
            raise CommandRefused("enable is refused after a stop", value=self.stop.reason, remedy="reset first")
        faulty = [drive.name for drive in self.drives if drive.state is DriveState.FAULT and not drive.resetting]
        if faulty:
            raise CommandRefused("enable is refused in FAULT", value=", ".join(faulty), remedy="reset first")
        return self._aim(Goal.ENABLED, now)

    def disable(self, now: int) -> None:
        """Aim at drives without power."""
        self._aim(Goal.DISABLED, now)

    def reset(self, now: int) -> None:
        """Forget the stop and aim at drives without power.

        Each drive in FAULT gets `fault reset` until it says that it has left FAULT. The level is held, since one lost
        frame must not leave a drive behind; a drive acts on the rising edge, so it acts once. A drive that restarted or
        does not answer is configured again first.

        Raises:
            CommandRefused: there is nothing to reset.
        """
        if not self.needs_reset:
            raise CommandRefused("reset is refused: nothing is stopped", remedy="reset only after a stop or in FAULT")
        self.stop.clear()
        self.cut.clear()
        self.goal = Goal.DISABLED
        for drive in self.drives:
            drive.recover()
        self._restart_transitions(now)

    def stop_for(self, trip: Trip, now: int, action: Action | None = None) -> bool:
        """Note a trip, with its own action or a given one; return True when it is the first, which stops the drives."""
        first = self.stop.add(trip, now, action)
        self.cut.update(trip.axes)
        if first:
            self.goal = Goal.STOPPED
            for drive in self.drives:
                drive.end_recovery()
        return first

    def set_up(self, now: int) -> None:
        """Take note that every drive has been configured again: what was known of them before is of the past."""
        for drive in self.drives:
            drive.set_up(now)
        self.all_enabled, self._judged_words = False, []

    def cut_unheard(self) -> None:
        """Take the power from drives of which a stopped robot hears nothing: nobody can say that they brake."""
        if self.stop.first is not None:
            self.cut.update(axis for axis, drive in enumerate(self.drives) if drive.silent)

    def power_off(self) -> None:
        """Take the power from drives that have braked; their transitions keep the times they have."""
        self.goal = Goal.DISABLED

    def _aim(self, goal: Goal, now: int) -> bool:
        if self.goal is goal:
            return False
        self.goal = goal
        self._restart_transitions(now)
        return True

    def _restart_transitions(self, now: int) -> None:
        """Count the time limit of a CiA 402 transition from `now`."""
        for drive in self.drives:
            drive.state_since = now

    def is_news(self, words: Sequence[int | None]) -> bool:
        """Return whether these statuswords differ from those of the newest complete tick."""
        return words != self._judged_words

    def judge(
        self, words: Sequence[int | None], missing: frozenset[int], missing_limit: int, now: int
    ) -> Iterator[Trip]:
        """Take the statuswords of a tick; yield what is to be said against the drives, one by one.

        Args:
            words: newest statusword of every drive, None before the first.
            missing: indices of the drives of which a TPDO stayed away in this tick.
            missing_limit: number of such ticks in a row after which a drive is given up.
            now: time, ns.
        """
        heading = self.heading
        for axis, drive in enumerate(self.drives):
            if missing or drive.missing:
                trip = drive.on_tick(axis in missing, missing_limit)
                if trip is not None:
                    yield trip
            word = words[axis]
            if word is not None and word != drive.word and axis not in missing:
                trip = drive.on_statusword(word, now)
                if trip is not None:
                    yield trip
            if drive.state in FAULTY and not drive.resetting and self.goal is Goal.DISABLED and self.stop.first is None:
                yield drive.faulty()
        if heading is not self.heading:  # the recovery is over, and the way to the goal begins
            self._restart_transitions(now)
        self.all_enabled = all([drive.state is DriveState.OPERATION_ENABLED for drive in self.drives])
        self._judged_words = [] if missing else list(words)

    def unbelievable(self, invalid: Sequence[Invalid | None]) -> Iterator[Trip]:
        """Yield what is to be said against drives of which too many reports in a row were not believed."""
        for axis, (drive, report) in enumerate(zip(self.drives, invalid, strict=True)):
            if report is not None and report.times >= self._report_limit and not drive.setup_due:
                text = f"{drive.name}: {report.text}"
                yield Trip(report.reason, text, report.times, self._report_limit, "reports", (axis,))

    def objections(self) -> Iterator[Trip]:
        """Yield what the statuswords of drives that are to be enabled say against them; call it once a tick."""
        for drive in self.drives:
            trip = drive.objection(self.all_enabled, self._status_limit)
            if trip is not None:
                yield trip

    def next_words(self) -> list[Controlword]:
        """Return the controlword that takes every drive one step towards the goal.

        A drive whose state is unknown is treated as one that is not ready, so it gets `disable voltage`.
        """
        goal = self.heading
        words = [next_command(drive.state or DriveState.NOT_READY_TO_SWITCH_ON, goal) for drive in self.drives]
        for axis in self.cut:
            words[axis] = Controlword.DISABLE_VOLTAGE
        for axis, drive in enumerate(self.drives):
            if drive.resetting and drive.state is DriveState.FAULT:
                words[axis] = Controlword.FAULT_RESET
        return words
