"""What the product machine is made of: the real parts wired as the nodes wire them, moved one period at a time."""

from __future__ import annotations

import contextlib
import io
import pickle
from dataclasses import dataclass, field
from enum import Enum
from struct import Struct
from typing import Any

import numpy as np
from sher3_common.operating_state import OperatingState
from sher3_common.reasons import Reason
from sher3_control.errors import StateCommandRefused
from sher3_control.law.admittance import LawInput, initial_state, step
from sher3_control.law.parameters import law_parameters
from sher3_control.nodes.heard import HeardState
from sher3_control.settings import ControlSettings
from sher3_control.supervision.detectors import EmergencyStopDetector, Finding, ReportedFault
from sher3_control.supervision.driver_reports import driver_stop
from sher3_control.supervision.supervisor import Supervisor
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.frame import FRAME_SIZE, pack_frame
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen import tpdo
from sher3_drivers.canopen.emcy import EMCY
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.drive.report import driver_report
from sher3_drivers.drive.supervisor_link import SupervisorLink
from sher3_drivers.errors import CommandRefused
from sher3_drivers.mock import drive as mock_drive
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale

ROBOT = load_robot().replace({"admittance.force_deadband": 0.0})
T = 2_000_000
SETTINGS = default_settings(protected=False).model_copy(update={"brake_time": 0.003, "missing_limit": 2})
CONTROL = ControlSettings.from_robot(ROBOT)
LAW = law_parameters(ROBOT, CONTROL)
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
GRACE = 0.003
SPEED = 0.001
COMMANDS = ("enable", "disable", "pause", "resume")
EVENTS = (
    "tick",
    *COMMANDS,
    "press",
    "release",
    "emergency on",
    "emergency off",
    "stream silent",
    "stream back",
    "overruns",
    "in time",
    "drive faults",
    "drive loses power stage",
    "bus passive",
)
LOSSY = (
    "commands lost",
    "reports lost",
    "supervisor unheard",
    "driver unheard",
    "drive faults unsaid",
    "drive restarts",
)
"""What channels that lose frames add, in one period: the drive's RPDO, or its TPDOs with all else it says; the
supervisor's heartbeat; the driver's report; the emergency message of a fault. And a drive that restarts."""
HARMLESS = frozenset({"tick", "disable", "release", "emergency off", "stream back", "in time"})
"""What an operator and the passing of time do to get out of anything."""


@dataclass
class Flag:
    """A detector whose finding is switched on and off."""

    reason: Reason
    on: bool = False
    active_when_disabled: bool = False
    cleared_by_recovery: bool = False

    def recover(self, now: int) -> None:
        """Nothing to forget."""

    def look(self, now: int) -> Finding:
        """Return the flag as a number."""
        return Finding(self.reason, float(self.on), 0.0, "1", "product machine")

    def check(self, now: int) -> Finding | None:
        """Object while it is on."""
        return self.look(now) if self.on else None


class DriveEnd:
    """The drives' end of a CAN channel: the state machine of the mock drives, ideal motion, no dictionary."""

    def __init__(self, axes: list[int]) -> None:
        self.axes, self.name, self.received_at, self.dropped = axes, f"product:{axes}", 0, 0
        self.states = dict.fromkeys(axes, mock_drive.SWITCH_ON_DISABLED)
        self.words = dict.fromkeys(axes, 0)
        self.targets = dict.fromkeys(axes, 0)
        self.position = dict.fromkeys(axes, 0.0)
        self.resets = 0
        self.down: set[int] = set()
        self.deaf: int | None = None
        self.mute: int | None = None
        self.extra = b""
        self._out = b""

    def fileno(self) -> int:
        """Nothing to wait on."""
        return -1

    def close(self) -> None:
        """Nothing to close."""

    def recv_frames(self) -> bytes:
        """Return what the drives have sent."""
        out, self._out = self._out, b""
        return out

    def send_frames(self, frames: bytes) -> None:
        """Take what the host sends: SYNC and RPDOs; its heartbeat needs no answer."""
        for at in range(0, len(frames), FRAME_SIZE):
            can_id = int.from_bytes(frames[at : at + 4], "little")
            if can_id == od.SYNC_ID:
                self._sync()
            elif can_id & 0x780 == od.RPDO_BASE:
                word, target = int.from_bytes(frames[at + 8 : at + 10], "little"), frames[at + 10 : at + 14]
                self._obey((can_id & 0x7F) - 1, word, int.from_bytes(target, "little", signed=True))

    def demand(self, axis: int) -> int:
        """Return the velocity a drive is commanded to [counts]: none unless it is enabled."""
        return self.targets[axis] if self.states[axis] == mock_drive.ENABLED else 0

    def restart(self, axis: int) -> None:
        """Restart a drive: it says so, and serves no PDO until it is set up."""
        self.states[axis], self.words[axis], self.targets[axis] = mock_drive.SWITCH_ON_DISABLED, 0, 0
        self.down.add(axis)
        self.extra += pack_frame(od.HEARTBEAT_BASE + axis + 1, bytes([0]))

    def set_up(self) -> None:
        """Take the configuration: every drive restarts and becomes OPERATIONAL, and what waited is gone."""
        for axis in self.axes:
            self.restart(axis)
        self.down.clear()
        self.extra = self._out = b""

    def _obey(self, axis: int, word: int, target: int) -> None:
        if axis == self.deaf or axis in self.down:
            return
        self.resets += bool(word & 0x80 and not self.words[axis] & 0x80)
        self.states[axis] = mock_drive.next_state(self.states[axis], word, self.words[axis])
        self.words[axis], self.targets[axis] = word, target

    def _sync(self) -> None:
        for axis in self.axes:
            scale = SCALES[axis]
            velocity = self.demand(axis) * scale.velocity
            self.position[axis] += velocity * T * 1e-9
            state = self.states[axis]
            following = mock_drive.FAULT if state == mock_drive.FAULT_REACTION else state
            if axis == self.mute or axis in self.down:
                self.states[axis] = following
                continue
            load, motor = (round(self.position[axis] / s) for s in (scale.load_encoder, scale.motor_encoder))
            one = tpdo.TPDO1_DATA.pack(load, state | 0x0210, 0)
            two = tpdo.TPDO2_DATA.pack(motor, round(velocity / scale.velocity))
            node = axis + 1
            for base, data in zip(od.TPDO_BASES, (one, two), strict=True):
                self._out += pack_frame(base + node, data)
            self._out += pack_frame(od.HEARTBEAT_BASE + node, bytes([5]))
            self.states[axis] = following
        self._out, self.extra = self._out + self.extra, b""


class Driver(MotorDriver):
    """The motor driver, whose configuration of the drives is one step: SDO transfers are tested elsewhere."""

    def configure(self, patience: float = 1.0) -> None:
        """Set every drive up."""
        for end in self.wire.links:
            end.set_up()


SHARED: list[Any] = [ROBOT, SETTINGS, LAW, CONTROL, *SCALES]
"""What never changes is no part of a frozen world, which has its number here."""
_NUMBERS = {id(constant): number for number, constant in enumerate(SHARED)}


class _Freezer(pickle.Pickler):
    """Asks about instances alone, a tenth of the things in a world; texts, numbers and tuples of them take no call."""

    def reducer_override(self, thing: Any) -> Any:
        if isinstance(thing, (Enum, Struct, np.dtype, type, AxisScale)) and id(thing) not in _NUMBERS:
            _NUMBERS[id(thing)] = len(SHARED)
            SHARED.append(thing)
        number = _NUMBERS.get(id(thing))
        return NotImplemented if number is None else (_shared, (number,))


def _shared(number: int) -> Any:
    return SHARED[number]


@dataclass
class World:
    """Everything that decides about motion, and what the test knows of its history.

    Attributes:
        released: the pedal was up, with nothing in the way, since the last stop: the test's own idea of armed.
    """

    drive: int = 0
    now: int = 1_000_000_000_000
    pressed: bool = False
    released: bool = False
    button: EmergencyStopDetector = field(default_factory=EmergencyStopDetector)
    report: ReportedFault = field(default_factory=lambda: ReportedFault("motor_driver", GRACE))
    stream: Flag = field(default_factory=lambda: Flag(Reason.WRENCH_STALE))
    loop: Flag = field(default_factory=lambda: Flag(Reason.OVERRUN))

    def __post_init__(self) -> None:
        self.supervisor = Supervisor([self.button, self.report, self.stream, self.loop])
        self.ends = [DriveEnd([ACTUATORS.index(n) for n in c.drives]) for c in SETTINGS.channels]
        self.driver = Driver(ROBOT, SETTINGS, self.ends, self.clock)
        self.glue, self.heard, self.law = SupervisorLink(self.driver), HeardState(0.03), initial_state()
        self.said: tuple[Any, Any] | None = None
        self.told: Finding | None = None

    def clock(self) -> int:
        """Return the stepped time."""
        return self.now

    def freeze(self) -> bytes:
        """Return the world as bytes, three times as fast to copy as objects; what never changes is shared."""
        buffer = io.BytesIO()
        _Freezer(buffer, pickle.HIGHEST_PROTOCOL).dump(self)
        return buffer.getvalue()

    @staticmethod
    def thaw(frozen: bytes) -> World:
        """Return a new world."""
        return pickle.loads(frozen)

    # One event, one period.

    def step(self, event: str) -> bool:
        """Apply an event and let one control period pass; return whether a state command was accepted."""
        accepted = self._apply(event)
        end = self._end
        end.deaf = self.drive if event == "commands lost" else None
        end.mute = self.drive if event == "reports lost" else None
        self._tick(event)
        return accepted

    @property
    def _end(self) -> DriveEnd:
        return next(end for end in self.ends if self.drive in end.axes)

    def _apply(self, event: str) -> bool:
        if event in COMMANDS:
            try:
                self.supervisor.command(event, self.now)
            except StateCommandRefused:
                return False
        elif event in ("press", "release"):
            self.pressed = event == "press"
        elif event.startswith("emergency"):
            self.button.feed(event.endswith("on"))
        elif event.startswith("stream"):
            self.stream.on = event.endswith("silent")
        elif event in ("overruns", "in time"):
            self.loop.on = event == "overruns"
        elif event not in ("tick", *LOSSY[:4]):
            self._break(event)
        return True

    def _break(self, event: str) -> None:
        end = self._end
        if event == "drive restarts":
            end.restart(self.drive)
        elif event == "bus passive":
            from sher3_drivers.bus.condition import BusCondition, error_frame

            end.extra += pack_frame(*error_frame(BusCondition.PASSIVE))
        elif event == "drive loses power stage":
            end.states[self.drive] = mock_drive.SWITCH_ON_DISABLED
        elif end.states[self.drive] not in (mock_drive.FAULT, mock_drive.FAULT_REACTION):
            end.states[self.drive] = mock_drive.FAULT_REACTION
            if event != "drive faults unsaid":
                end.extra += pack_frame(od.EMCY_BASE + self.drive + 1, EMCY.pack(0x2310, 1, bytes(5)))

    def _tick(self, event: str) -> None:
        self.now += T
        if event != "supervisor unheard":
            self.glue.hear(self.supervisor.status.heartbeat)
        self.driver.tick(self.now)
        self.driver.collect_positions()
        self.driver.collect()
        said = self.driver.stop.first, self.driver.stop.action
        if said != self.said:  # a report says the same until something else happens
            self.said, self.told = said, driver_stop(*driver_report(self.driver))
        if event != "driver unheard":
            self.report.feed(self.told, self.now)
        self.supervisor.check(self.now)
        beat = self.supervisor.status.heartbeat
        self.heard.feed(beat, self.now)
        if event != "supervisor unheard":
            self.glue.hear(beat)
        self._command()

    def _command(self) -> None:
        """One tick of the law on a steady push, and its command to the driver."""
        wiggle = 1e-6 * (self.now // T % 7)
        wrench = (1.0 + wiggle, wiggle, -LAW.tool_mass * 9.81, 0.0, 0.0, 0.0)
        stamp = self.now - (10**9 if self.stream.on else 0)
        flags = (self.heard.enabled(self.now), True, stamp, wrench, self.now, float(self.pressed), self.button.pressed)
        gains = (1.0, CONTROL.admittance.linear_gain, CONTROL.admittance.angular_gain, 0, (0.0,) * 6)
        self.law, out = step(self.law, LawInput(self.now, *flags, self.now, 0.0, 0.0, *gains), LAW)
        objection = not flags[0] or self.stream.on or self.button.pressed
        self.released = not objection and (self.released or not self.pressed)
        velocity = SPEED if any(out.twist) else 0.0
        with contextlib.suppress(CommandRefused):
            self.driver.command(self.now, (velocity,) * 5)

    # What is seen from outside.

    @property
    def state(self) -> OperatingState:
        """The operating state."""
        return self.supervisor.state

    @property
    def drives(self) -> tuple[int, ...]:
        """The true CiA 402 states."""
        return tuple(end.states[axis] for end in self.ends for axis in end.axes)

    @property
    def demands(self) -> tuple[int, ...]:
        """The velocities the drives are commanded to [counts]; a drive that has just lost its command has none new."""
        return tuple(end.demand(axis) for end in self.ends for axis in end.axes if axis != end.deaf)

    @property
    def resets(self) -> int:
        """Rising edges of fault reset that the drives have seen."""
        return sum(end.resets for end in self.ends)

    @property
    def faulty(self) -> bool:
        """Whether something is wrong right now that must keep the robot still."""
        well = {mock_drive.SWITCH_ON_DISABLED, mock_drive.READY, mock_drive.SWITCHED_ON, mock_drive.ENABLED}
        down = any(end.down for end in self.ends)
        return self.button.pressed or self.stream.on or self.loop.on or down or not set(self.drives) <= well

    @property
    def recovering(self) -> tuple[frozenset[int], bool]:
        """Which drives a recovery is resetting, and whether it has still to configure them."""
        drives = self.driver.session.drives
        return frozenset(i for i, d in enumerate(drives) if d.resetting), self.driver.session.setup_due

    @property
    def _known(self) -> tuple[int, bool, bool]:
        health = self.driver.session.drives[self.drive]
        return min(health.missing, SETTINGS.missing_limit), health.restarted, health.silent

    def key(self) -> tuple[Any, ...]:
        """Return all that the future depends on, without absolute times, positions and counters."""
        driver, status, stop = self.driver, self.supervisor.status, self.driver.stop
        alone = self.drive
        others = frozenset(i for i in range(len(ACTUATORS)) if i != alone)
        drives, seen = self.drives, [health.state for health in driver.session.drives]
        words = [end.words[axis] >> 7 for end in self.ends for axis in end.axes]
        since = min(3, (self.now - stop.since) // T) if stop.first else 0
        deaf = min(3, max(0, (self.report.deaf_until - self.now + T) // T))
        told = self.report.finding
        return (
            (status.state, status.action, status.first_fault is None),
            (self.pressed, self.button.pressed, self.stream.on, self.loop.on),
            (told and told.action, deaf),
            (self.law.armed, self.law.pressed, any(self.law.velocity), self.released, self.heard.enabled(self.now)),
            (driver.goal, stop.first is None, stop.action, since, self.recovering),
            (
                driver.gate.following,
                driver.session.all_enabled,
                driver.watches.motion.rest.resting,
                driver.watches.motion.demand.braked,
                self.glue.state,
                self.glue.action,
            ),
            (drives[alone], seen[alone], words[alone], any(self.demands), alone in self._end.down, self._known),
            frozenset((drives[i], seen[i], words[i]) for i in others),
            tuple(len(end.extra) for end in self.ends),
        )
