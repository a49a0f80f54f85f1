"""Compute a recorded run again: the law on the recorded inputs must give the recorded commands bit for bit.

Takes anything with `streams` by topic whose columns are arrays (a run of `sher3_bags`) and the robot in force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot, Sher3Error, parse_json
from sher3_kinematics import RobotKinematics, kernel_parameters

from .admittance import NO_WRENCH, LawInput, LawParameters, initial_state, step
from .angles import roll_and_tilt
from .cooperative import RESTING, VelocityModes
from .law_parameters import law_parameters
from .live_parameters import LiveParameters, from_json
from .ownership import MODE_CODES, Mode
from .position_controller import position_commands
from .rcm import NO_HOLD
from .reasons import Reason
from .settings import MotionSettings
from .speed_cap import Regime, speed_cap
from .tick_records import AdmittanceRecord, admittance_record, motion_record

Array = NDArray[Any]


class ReplayError(Sher3Error):
    """The run lacks what a replay needs."""


class Recording(Protocol):
    """The part of a run that a replay needs."""

    @property
    def streams(self) -> Mapping[str, Any]:
        """Streams by topic relative to `/sher3`."""


@dataclass(frozen=True)
class Replay:
    """Outcome: how many commands were computed again, how many differ in any bit, and the largest difference.

    Attributes:
        first: stamp of the first difference [ns], or None.
        skipped: commands before the law's memory is known, or of modes that are not computed again.
    """

    compared: int
    different: int
    largest: float
    first: int | None
    skipped: int


class Lookup:
    """Samples of a stream by their exact stamp."""

    def __init__(self, run: Recording, topic: str) -> None:
        if topic not in run.streams:
            raise ReplayError(f"the run has no {topic}", remedy="record all topics")
        self.stream = run.streams[topic]
        self.row = {stamp: k for k, stamp in enumerate(self.stream.stamp.tolist())}

    def __call__(self, stamp: int) -> int | None:
        """Return the row, None for a stamp of -1.

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

    A recording that starts in the middle is compared from the first released pedal on: a stop clears the law's memory.

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
            count.add(line.stamp, np.array(output.twist), twist, known)
        known = known or (n >= parameters.frozen_samples and output.reason is Reason.PEDAL_RELEASED)
    return count.result()


def replay_motion(run: Recording, robot: Robot) -> Replay:
    """Compute `servo_jv` again: the host law where there is a `setpoint_js`, the twist through J in cooperative mode.

    A recording that starts in a motion about a remote centre is compared from the first rest on, where the law has no
    memory.

    Raises:
        ReplayError: a topic or a sample that was used is not in the run.
        SettingsError: a record is damaged.
    """
    joints, twists, recorded = (Lookup(run, name) for name in ("measured_js", "servo_cv", "servo_jv"))
    references = Lookup(run, "setpoint_js") if "setpoint_js" in run.streams else None
    limit = np.array([a.limits.velocity for a in robot.actuators])
    versions = {(data := parse_json(text))["version"]: data for text in run.streams["motion/settings"].data}
    modes, previous, rested, count = _Modes(robot, versions), RESTING, False, _Comparison()
    for text in run.streams["motion/inputs"].data:
        line = motion_record(text)
        row = recorded.row.get(line.stamp)
        if row is None:
            continue
        actual = recorded.stream.velocity[row]
        rested, about_centre = rested or not actual.any(), False
        used, reference = joints(line.joints_stamp), references and references.row.get(line.stamp)
        if line.reason != Reason.MOVING or used is None:
            command: Array | None = np.zeros(5)
        elif references is not None and reference is not None:
            r = references.stream
            q = joints.stream.position[used]
            command = position_commands(r.position[reference], r.velocity[reference], q, robot.position_gain, limit)
        elif line.mode in (MODE_CODES[None], MODE_CODES[Mode.COOPERATIVE]):
            k = twists(line.twist_stamp)
            twist = np.zeros(6) if k is None else np.concatenate([twists.stream.linear[k], twists.stream.angular[k]])
            command = modes.velocity(joints.stream.position[used], twist, previous, line.version)
            about_centre = modes.at(line.version).centre is not None
        else:
            command = None
        count.add(
            line.stamp,
            actual if command is None else command,
            actual,
            command is not None and (rested or not about_centre),
        )
        previous = tuple(actual.tolist())
    return count.result()


class _Modes:
    """The cooperative velocity with the remote centre of a version; the hold passes from one version to the next."""

    def __init__(self, robot: Robot, versions: dict[int, dict[str, Any]]) -> None:
        kinematics = RobotKinematics(robot)
        self._by_version, self._hold = {}, NO_HOLD
        for version, data in versions.items():
            # Recordings from before the hold had none.
            mode = VelocityModes(kinematics, data["settings"]["rcm_gain"], data["settings"].get("rcm_integral", 0.0))
            mode.centre = None if data["rcm"] is None else np.array(data["rcm"])
            # Recordings from before there were regimes had no cap either.
            regime = Regime(data.get("regime", Regime.BENCH.value))
            mode.cap = speed_cap(MotionSettings(**data["settings"]), regime)
            self._by_version[version] = mode

    def velocity(self, q: Array, twist: Array, previous: tuple[float, ...], version: int) -> Array:
        """Return the velocity (5,)."""
        mode = self.at(version)
        mode.hold = self._hold
        velocity = mode.from_twist(tuple(q.tolist()), tuple(twist.tolist()), previous).velocity
        self._hold = mode.hold
        return np.array(velocity)

    def at(self, version: int) -> VelocityModes:
        """Return the modes of a version."""
        if version not in self._by_version:
            raise ReplayError("a version of motion/settings is missing", value=version, remedy="record from the start")
        return self._by_version[version]


class _Inputs:
    """The law's input at a recorded tick."""

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
        """Return parameters and input of a tick."""
        if line.version not in self._versions:
            raise ReplayError("a version of admittance/settings is missing", value=line.version, remedy="record anew")
        live, parameters = self._versions[line.version]
        w, p, j = self.wrench(line.wrench_stamp), self.pedal(line.pedal_stamp), self.joints(line.joints_stamp)
        wrench, travel, emergency, roll, tilt = NO_WRENCH, 0.0, False, 0.0, 0.0
        if w is not None:
            stream = self.wrench.stream
            wrench = tuple([*stream.force[w].tolist(), *stream.torque[w].tolist()])  # type: ignore[assignment]
        if p is not None:
            travel, emergency = float(self.pedal.stream.axes[p][0]), bool(self.pedal.stream.buttons[p][0])
        if j is not None:
            q = self.joints.stream.position[j].tolist()
            roll, tilt = roll_and_tilt(self._parameters, q[3], q[4])
        return parameters, LawInput(
            line.stamp, bool(line.enabled), bool(line.owner), line.wrench_stamp, wrench, line.pedal_stamp, travel,
            emergency, line.joints_stamp, roll, tilt, live.speed_scale, live.linear_gain, live.angular_gain,
            int(live.lock), live.bias,
        )  # fmt: skip


class _Comparison:
    def __init__(self) -> None:
        self._compared = self._different = self._skipped = 0
        self._largest, self._first = 0.0, None

    def add(self, stamp: int, computed: Array, recorded: Array, known: bool) -> None:
        """Compare the bits of one command."""
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
        return Replay(self._compared, self._different, self._largest, self._first, self._skipped)
