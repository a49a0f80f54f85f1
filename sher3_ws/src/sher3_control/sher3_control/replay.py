"""Compute a recorded run again: the laws on the recorded inputs must give the recorded commands bit for bit.

A recording is anything with `streams` by topic whose columns are arrays, such as a run of `sher3_bags`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sher3_common import Sher3Error, parse_json
from sher3_common.reasons import Reason
from sher3_common.vectors import ZERO_TWIST
from sher3_description import Robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel import kernel_parameters

from sher3_control.law.admittance import NO_WRENCH, LawInput, LawParameters, initial_state, step
from sher3_control.law.angles import roll_and_tilt
from sher3_control.law.live_parameters import LiveParameters, from_json
from sher3_control.law.parameters import law_parameters
from sher3_control.law.pedal import pedal_reading
from sher3_control.law.position_controller import position_commands
from sher3_control.motion.cooperative import RESTING, VelocityModes
from sher3_control.motion.ownership import MODE_CODES, Mode
from sher3_control.motion.rcm import NO_HOLD
from sher3_control.motion.speed_cap import Regime, axis_caps, speed_cap
from sher3_control.settings import MotionSettings
from sher3_control.tick_records import AdmittanceRecord, MotionRecord, admittance_record, motion_record

Array = NDArray[Any]


class ReplayError(Sher3Error):
    """The run lacks something that its replay needs."""


class Recording(Protocol):
    """The part of a run that a replay needs."""

    @property
    def streams(self) -> Mapping[str, Any]:
        """Streams by topic relative to `/sher3`."""


@dataclass(frozen=True)
class Replay:
    """Outcome of a replay.

    Attributes:
        compared: number of commands that were computed again.
        different: number of those that differ in any bit.
        largest: largest difference of a component [m/s or rad/s].
        first: stamp of the first difference [ns], or None.
        skipped: number of commands before the memory of the law is known, or of modes that are not computed again.
    """

    compared: int
    different: int
    largest: float
    first: int | None
    skipped: int


class Lookup:
    """Samples of a stream by their exact stamp.

    Attributes:
        stream: the stream.
        row: row of each stamp [ns].

    Raises:
        ReplayError: the run has no such topic.
    """

    def __init__(self, run: Recording, topic: str) -> None:
        if topic not in run.streams:
            raise ReplayError(f"the run has no {topic}", remedy="record all topics")
        self.stream = run.streams[topic]
        self.row = {stamp: k for k, stamp in enumerate(self.stream.stamp.tolist())}

    def __call__(self, stamp: int) -> int | None:
        """Return the row of a stamp [ns], None for -1, which stands for no sample.

        Raises:
            ReplayError: the sample was used but not recorded.
        """
        if stamp < 0:
            return None
        if stamp not in self.row:
            raise ReplayError("a sample that was used is not in the run", value=stamp, remedy="record without drops")
        return self.row[stamp]


def replay_admittance(run: Recording, robot: Robot) -> Replay:
    """Run the cooperative law over the recorded inputs and compare with `servo_cv`.

    A recording that starts in the middle of a session is compared from the first released pedal on, because a stop
    clears the memory of the law.

    Raises:
        ReplayError: a topic or a sample that was used is not in the run.
        SettingsError: a record is damaged.
    """
    inputs = _Inputs(run, robot)
    recorded = Lookup(run, "servo_cv")
    state, known, count = initial_state(), False, _Comparison()
    lines = [admittance_record(text) for text in run.streams["admittance/inputs"].data]
    for n, line in enumerate(lines):
        parameters, law_input = inputs.at(line)
        if n == 0 and line.tick == 0:
            known = True
        state, output = step(state, law_input, parameters)
        row = recorded.row.get(line.stamp)
        if row is not None:
            stream = recorded.stream
            twist = np.concatenate([stream.linear[row], stream.angular[row]])
            count.add(line.stamp, np.array(output.twist), twist, known=known)
        known = known or (n >= parameters.frozen_samples and output.reason is Reason.PEDAL_RELEASED)
    return count.result()


def replay_motion(run: Recording, robot: Robot) -> Replay:
    """Compute `servo_jv` again and compare it with the recording.

    Where there is a `setpoint_js` the host law is computed, in the cooperative mode the twist through the Jacobian. The
    velocity commands of a user are skipped. A recording that starts in a motion about a remote centre is compared from
    the first rest on, where the law has no memory.

    Raises:
        ReplayError: a topic or a sample that was used is not in the run.
        SettingsError: a record is damaged.
    """
    commands, recorded = _MotionCommands(run, robot), Lookup(run, "servo_jv")
    previous, rested, count = RESTING, False, _Comparison()
    for text in run.streams["motion/inputs"].data:
        line = motion_record(text)
        row = recorded.row.get(line.stamp)
        if row is None:
            continue
        actual = recorded.stream.velocity[row]
        rested = rested or not actual.any()
        command, needs_memory = commands.at(line, previous)
        if command is None:
            count.add(line.stamp, actual, actual, known=False)
        else:
            count.add(line.stamp, command, actual, known=rested or not needs_memory)
        previous = tuple(actual.tolist())
    return count.result()


class _MotionCommands:
    """The velocity commands of the kinematics node, computed from a recording."""

    def __init__(self, run: Recording, robot: Robot) -> None:
        self._joints, self._twists = Lookup(run, "measured_js"), Lookup(run, "servo_cv")
        self._references = Lookup(run, "setpoint_js") if "setpoint_js" in run.streams else None
        self._gain = robot.position_gain
        self._limit = np.array([a.limits.velocity for a in robot.actuators])
        versions = {(data := parse_json(text))["version"]: data for text in run.streams["motion/settings"].data}
        self._modes = _Modes(robot, versions)

    def at(self, line: MotionRecord, previous: tuple[float, ...]) -> tuple[Array | None, bool]:
        """Return the velocity (5,) of a tick, and whether it needs the memory of the law.

        The velocity is None where it is not computed: a velocity mode follows a command of the user. `previous` is the
        recorded velocity (5,) of the tick before.
        """
        used = self._joints(line.joints_stamp)
        if line.reason != Reason.MOVING or used is None:
            return np.zeros(len(previous)), False
        q = self._joints.stream.position[used]
        if self._references is not None and (row := self._references.row.get(line.stamp)) is not None:
            reference = self._references.stream
            q_ref, qd_ref = reference.position[row], reference.velocity[row]
            return position_commands(q_ref, qd_ref, q, self._gain, self._limit), False
        if line.mode in (MODE_CODES[None], MODE_CODES[Mode.COOPERATIVE]):
            velocity = self._modes.velocity(q, self._twist(line.twist_stamp), previous, line.version)
            return velocity, self._modes.at(line.version).centre is not None
        return None, False

    def _twist(self, stamp: int) -> Array:
        """Return the recorded twist (6,) in {b} of a stamp, zero for none."""
        row = self._twists(stamp)
        if row is None:
            return np.zeros(len(ZERO_TWIST))
        return np.concatenate([self._twists.stream.linear[row], self._twists.stream.angular[row]])


class _Modes:
    """The velocity modes by version of the settings; the hold of the remote centre passes from version to version."""

    def __init__(self, robot: Robot, versions: dict[int, dict[str, Any]]) -> None:
        kinematics = RobotKinematics(robot)
        self._by_version, self._hold = {}, NO_HOLD
        for version, data in versions.items():
            # Recordings made before there was a hold have no rate for it.
            mode = VelocityModes(kinematics, data["settings"]["rcm_gain"], data["settings"].get("rcm_integral", 0.0))
            mode.centre = None if data["rcm"] is None else np.array(data["rcm"])
            # Recordings made before there were regimes had no cap.
            regime = Regime(data.get("regime", Regime.BENCH.value))
            settings = MotionSettings(**data["settings"])
            mode.cap = speed_cap(settings, regime)
            if "leg_share" in data["settings"]:  # nor a cap of the actuators
                mode.axis_caps = axis_caps(settings, mode.cap, mode.axis_caps)
            self._by_version[version] = mode

    def velocity(self, q: Array, twist: Array, previous: tuple[float, ...], version: int) -> Array:
        """Return the actuator velocity (5,) at positions `q` (5,) for a tip twist (6,) in {b}."""
        mode = self.at(version)
        mode.hold = self._hold
        velocity = mode.from_twist(tuple(q.tolist()), tuple(twist.tolist()), previous).velocity
        self._hold = mode.hold
        return np.array(velocity)

    def at(self, version: int) -> VelocityModes:
        """Return the modes of a version; raises ReplayError for one that is not in the run."""
        if version not in self._by_version:
            raise ReplayError("a version of motion/settings is missing", value=version, remedy="record from the start")
        return self._by_version[version]


class _Inputs:
    """The input and the constants of the cooperative law at a recorded tick."""

    def __init__(self, run: Recording, robot: Robot) -> None:
        self.wrench, self.pedal, self.joints = (
            Lookup(run, name) for name in ("force/measured_cf", "pedal/measured", "measured_js")
        )
        self._parameters = np.array(kernel_parameters(robot))
        self._versions: dict[int, tuple[LiveParameters, LawParameters]] = {}
        for text in run.streams["admittance/settings"].data:
            live, settings = from_json(text)
            self._versions[live.version] = (live, law_parameters(robot, settings))

    def at(self, line: AdmittanceRecord) -> tuple[LawParameters, LawInput]:
        """Return constants and input of a tick; raises ReplayError where the run lacks a sample or a version."""
        if line.version not in self._versions:
            raise ReplayError("a version of admittance/settings is missing", value=line.version, remedy="record anew")
        live, parameters = self._versions[line.version]
        w, p, j = self.wrench(line.wrench_stamp), self.pedal(line.pedal_stamp), self.joints(line.joints_stamp)
        wrench, travel, emergency, roll, tilt = NO_WRENCH, 0.0, False, 0.0, 0.0
        if w is not None:
            stream = self.wrench.stream
            wrench = tuple([*stream.force[w].tolist(), *stream.torque[w].tolist()])  # type: ignore[assignment]
        if p is not None:
            travel, emergency = pedal_reading(self.pedal.stream.axes[p], self.pedal.stream.buttons[p])
        if j is not None:
            q = self.joints.stream.position[j].tolist()
            roll, tilt = roll_and_tilt(self._parameters, q[3], q[4])
        return parameters, LawInput(
            line.stamp, bool(line.enabled), bool(line.owner), line.wrench_stamp, wrench, line.pedal_stamp, travel,
            emergency, line.joints_stamp, roll, tilt, live.speed_scale, live.linear_gain, live.angular_gain,
            int(live.lock), live.bias,
        )  # fmt: skip


class _Comparison:
    """Counts equal and different commands."""

    def __init__(self) -> None:
        self._compared = self._different = self._skipped = 0
        self._largest, self._first = 0.0, None

    def add(self, stamp: int, computed: Array, recorded: Array, known: bool) -> None:
        """Compare the bits of one command; it is skipped where the memory of the law is not `known`."""
        if not known:
            self._skipped += 1
            return
        self._compared += 1
        if np.asarray(computed).tobytes() == np.asarray(recorded).tobytes():
            return
        self._different += 1
        self._largest = max(self._largest, float(np.abs(computed - recorded).max()))
        self._first = self._first or stamp  # type: ignore[assignment]

    def result(self) -> Replay:
        """Return the counts so far."""
        return Replay(self._compared, self._different, self._largest, self._first, self._skipped)
