"""Figures of one run: tip path, force against velocity, tracking per axis, timing per topic."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common import parse_json
from sher3_description import Robot, load_robot

from sher3_bags.figures.statistics import common, smooth, width_of
from sher3_bags.figures.timing import TopicTiming, topic_timing
from sher3_bags.figures.tracking import SMOOTHING, AxisError, axis_errors, drive_error, position_error, velocity_error
from sher3_bags.run import Run


@dataclass(frozen=True)
class TipPath:
    """Path of the tip in {b}: its length and its extent along each axis [m], and its largest speed [m/s]."""

    length: float
    extent: tuple[float, float, float]
    max_speed: float


@dataclass(frozen=True)
class ForceVelocity:
    """How the tip moves with the force on the handle while the pedal is pressed.

    Attributes:
        gain: Least-squares slope of velocity on force [(m/s)/N].
        correlation: Correlation of force and velocity, -1 to 1.
        samples: Number of samples used.
        max_force: Largest force [N], tared.
        doubt: Why the figures mean nothing, empty where they do.
    """

    gain: float
    correlation: float
    samples: int
    max_force: float
    doubt: str = ""


@dataclass(frozen=True)
class Analysis:
    """Figures of one run. A figure whose topics the run lacks is None or empty.

    Attributes:
        source: Path of the bag.
        duration: Time [s] from the first to the last stamp.
        topics: Timing by topic.
        position_tracking: setpoint_js minus measured_js (load encoder), per axis.
        drive_tracking: Integral of drives/setpoint_jv minus the travel of the motor, per axis.
        velocity_tracking: drives/setpoint_jv minus the motor velocity, averaged over 20 ms, per axis.
        tip: Path of the tip by measured_cp.
        tracker_rms: Root mean square [m] of the distance between the tracker and measured_cp.
        force_velocity: Velocity against force; see `ForceVelocity`.
        recorder_drops: Samples that the recorder itself counted as missing, by topic.
    """

    source: str
    duration: float
    topics: dict[str, TopicTiming]
    position_tracking: tuple[AxisError, ...]
    drive_tracking: tuple[AxisError, ...]
    velocity_tracking: tuple[AxisError, ...]
    tip: TipPath | None
    tracker_rms: float | None
    force_velocity: ForceVelocity | None
    recorder_drops: dict[str, int]

    @property
    def dropped(self) -> int:
        """Number of samples missing on the grid, all topics together."""
        return sum(timing.dropped for timing in self.topics.values())

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as plain data."""
        return {**asdict(self), "dropped": self.dropped}


def analyse(run: Run, robot: Robot | None = None) -> Analysis:
    """Compute the figures of a run; `robot` is by default the one attached to the bag, else the nominal one.

    Raises:
        InvalidRobot: the attached robot.yaml is not valid.
    """
    if robot is None:
        robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    return Analysis(
        source=str(run.path or ""),
        duration=(run.end - run.start) * 1e-9,
        topics=topic_timing(run, robot),
        position_tracking=axis_errors(run, robot, position_error),
        drive_tracking=axis_errors(run, robot, drive_error),
        velocity_tracking=axis_errors(run, robot, velocity_error),
        tip=_tip(run),
        tracker_rms=_tracker_rms(run),
        force_velocity=_force_velocity(run, robot),
        recorder_drops=_recorder_drops(run),
    )


def _tip(run: Run) -> TipPath | None:
    if "measured_cp" not in run or len(run["measured_cp"]) < 2:
        return None
    position = run["measured_cp"].position
    step = np.linalg.norm(np.diff(position, axis=0), axis=1)
    x, y, z = np.ptp(position, axis=0).tolist()
    return TipPath(float(step.sum()), (x, y, z), float(np.linalg.norm(tip_velocity(run), axis=1).max()))


def tip_velocity(run: Run) -> NDArray[np.float64]:
    """Return the tip velocity (n, 3) in {b} at the stamps of measured_cp, m/s, averaged over 20 ms."""
    table = run["measured_cp"]
    seconds = table.seconds()
    if len(table) < 2 or not (np.diff(seconds) > 0).all():
        return np.zeros((len(table), 3))
    return smooth(np.gradient(table.position, seconds, axis=0), width_of(table.stamp, SMOOTHING))


def force_in_base(run: Run) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return stamps (n,), force (n, 3) in {b} and whether the pedal is pressed (n,).

    {f} is parallel to {t}, so the rotation of measured_cp applies. The force is tared by its median with the pedal
    released (by its first sample when it never is) and averaged over 20 ms.
    """
    force, pose, pedal = run["force/measured_cf"], run["measured_cp"], run["pedal/measured"]
    rows_f, rows_p = common(force.stamp, pose.stamp)
    stamp = force.stamp[rows_f]
    held = np.clip(np.searchsorted(pedal.stamp, stamp, side="right") - 1, 0, None)
    pressed = pedal.axes[held, 0] > 0.0
    from scipy.spatial.transform import Rotation  # slow to import, and not needed before a case is read

    orientation = Rotation.from_quat(pose.orientation[rows_p])
    base = orientation.apply(force.force[rows_f])
    base -= np.median(base[~pressed], axis=0) if (~pressed).any() else base[0]
    return stamp, smooth(base, width_of(stamp, SMOOTHING)), pressed


def force_and_velocity(run: Run) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return tared force (m, 3) [N] and tip velocity (m, 3) [m/s] in {b} while the pedal is pressed.

    None when the run lacks a topic that this needs.
    """
    if not all(topic in run for topic in ("force/measured_cf", "measured_cp", "pedal/measured")):
        return None
    stamp, force, pressed = force_in_base(run)
    if pressed.sum() < 2:
        return None
    rows, _ = common(run["measured_cp"].stamp, stamp)
    return force[pressed], tip_velocity(run)[rows][pressed]


def _force_velocity(run: Run, robot: Robot) -> ForceVelocity | None:
    pair = force_and_velocity(run)
    if pair is None:
        return None
    force, velocity = pair
    # The law is straight only above its deadband: v = gain (F - deadband).
    size = np.linalg.norm(force, axis=1, keepdims=True)
    above = force * np.clip(1 - robot.admittance.force_deadband / np.maximum(size, 1e-12), 0, None)
    power = float((above**2).sum())
    norm = np.sqrt(power * float((velocity**2).sum()))
    product = float((above * velocity).sum())
    return ForceVelocity(
        gain=product / power if power else 0.0,
        correlation=product / norm if norm else 0.0,
        samples=len(force),
        max_force=float(size.max()),
        doubt=_doubt(size, velocity, robot),
    )


MOVES = 1e-4
"""Speed of the tip [m/s] that a hand below the deadband cannot cause."""
MOSTLY = 0.5
"""Share of the samples with the pedal pressed that must contradict the tare before the figures are doubted."""


def _doubt(size: NDArray[np.float64], velocity: NDArray[np.float64], robot: Robot) -> str:
    """Return why force against velocity means nothing: the tip moves and no force is left after the tare."""
    moving = np.linalg.norm(velocity, axis=1) > MOVES
    if not moving.any():
        return ""
    unexplained = float((size[moving, 0] <= robot.admittance.force_deadband).mean())
    if unexplained <= MOSTLY:
        return ""
    return (
        f"in {unexplained:.0%} of the motion the force is within the deadband; the recording began under a push, which "
        "the tare took, or another command moved the robot"
    )


def _tracker_rms(run: Run) -> float | None:
    if "tracker/measured_cp" not in run or "measured_cp" not in run:
        return None
    tracker, pose = run["tracker/measured_cp"], run["measured_cp"]
    a, b = common(tracker.stamp, pose.stamp)
    if not len(a):
        return None
    return float(np.sqrt(((tracker.position[a] - pose.position[b]) ** 2).sum(axis=1).mean()))


def _recorder_drops(run: Run) -> dict[str, int]:
    record = run.records.get("sher3.recording", {})
    return {topic: int(parse_json(entry)["dropped"]) for topic, entry in record.items()}
