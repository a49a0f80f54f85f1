"""A film: the scene along a recording, with what happened beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run
from sher3_bags.figures.analysis import force_in_base, tip_velocity
from sher3_bags.figures.tracking import position_error, velocity_error
from sher3_common import Sher3Error, parse_json
from sher3_description import Robot, load_robot
from sher3_kinematics import RobotKinematics

from sher3_view.errors import ViewError
from sher3_view.scene import Primitive, RobotState, Scene

Floats = NDArray[np.float64]
RATE = 30.0
"""Frames per second: the eye sees no step, and the page moves the parts between them."""
MOST_FRAMES = 1200
"""Frames of the longest film, 40 s at full rate; more seconds get fewer frames each, so that the page stays small."""


class Span(NamedTuple):
    """A time in which the robot was in one state: from and to [s], state, and why."""

    start: float
    end: float
    state: str
    reason: str


@dataclass(frozen=True, eq=False)
class Film:
    """The scene along a run, n frames.

    Attributes:
        name: of the recording.
        seconds: (n,) time of the frames since the first stamp of the run [s].
        fixed: the parts that never move.
        moving: the parts that move, as in the first frame.
        points: (n, k, 3) [m] in {b}, the points of all moving parts in their order; NaN where a part is not there.
        position: (n, 5) actuator positions.
        tip: (n, 3) [m] in {b}.
        force: (n, 3) [N] in {b}, tared; zero where it was not recorded.
        speed: (n,) of the tip [m/s].
        cap: (n,) speed cap [m/s], infinite on the bench.
        tracked: what `tracking` is about, `position` or `velocity`.
        tracking: (n, 5) wanted minus measured position [m, rad] or velocity [m/s, rad/s]; NaN where it cannot be told.
        pedal: (n,) travel, 0 to 1.
        states: operating states with their reasons.
        motion: why the cooperative mode moved or did not.
        limits: rows (name, unit, lower, upper) of the actuators [m, rad].
        edge: (n,) distance [m] of the platform to the edge of its workspace.
        dropped: samples missing in the recording: cycles that a node lost, or lost on the way to the bag.
    """

    name: str
    seconds: Floats
    fixed: list[Primitive]
    moving: list[Primitive]
    points: Floats
    position: Floats
    tip: Floats
    force: Floats
    speed: Floats
    cap: Floats
    tracked: str
    tracking: Floats
    pedal: Floats
    states: list[Span]
    motion: list[Span]
    limits: list[tuple[str, str, float, float]]
    edge: Floats
    dropped: int


def film_of(run: Run, robot: Robot | None = None) -> Film:
    """Return the film of a run; the robot is by default the one that the bag carries, else the nominal one.

    Raises:
        ViewError: `measured_js` is missing or holds less than two finite samples.
    """
    if robot is None:
        robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    kinematics = RobotKinematics(robot)
    stamps, position = joints_of(run)
    frames = _frames(stamps)
    q = at_times(stamps, position, frames)
    q, frames = _reachable(kinematics, q, frames)
    force, centres = _force(run, frames), _remote_centre(run, frames)
    tracked, tracking = _tracking(run, frames)
    scene = Scene(kinematics)
    shots = [
        scene.moving(RobotState(row, f, None if np.isnan(c).any() else c))
        for row, f, c in zip(q, force, centres, strict=True)
    ]
    return Film(
        name=run.path.name if run.path else "run",
        seconds=(frames - run.start).astype(np.float64) * 1e-9,
        fixed=scene.fixed(),
        moving=shots[0],
        points=np.array([np.concatenate([part.points for part in shot]) for shot in shots]),
        position=q,
        tip=kinematics.transform_tip_to_base_batch(q)[1],
        force=force,
        speed=_speed(run, frames),
        cap=_cap(run, frames),
        tracked=tracked,
        tracking=tracking,
        pedal=_sampled(run, "pedal/measured", "axes", frames, 1)[:, 0],
        states=_spans(run, ("supervisor/status", "operating_state")),
        motion=_spans(run, ("admittance/status",)),
        limits=[
            (a.name, "rad" if a.kind == "revolute" else "m", a.limits.lower, a.limits.upper) for a in robot.actuators
        ],
        edge=np.array([kinematics.delta.edge_distance(centre) for centre in kinematics.delta.forward_batch(q[:, :3])]),
        dropped=_dropped(run),
    )


def joints_of(run: Run) -> tuple[NDArray[np.int64], Floats]:
    """Return the stamps (n,) [ns] and the positions (n, 5) of the finite samples of `measured_js`, in order.

    Raises:
        ViewError: less than two.
    """
    if "measured_js" not in run or run["measured_js"].position is None:
        raise ViewError("there is no measured_js, so no robot to show", remedy="record measured_js too")
    table = run["measured_js"]
    rows = np.isfinite(table.position).all(axis=1)
    if rows.sum() < 2:
        raise ViewError("measured_js has too few finite samples", value=int(rows.sum()), limit="at least 2")
    order = np.argsort(table.stamp[rows], kind="stable")
    return table.stamp[rows][order], table.position[rows][order]


def at_times(stamps: NDArray[np.int64], position: Floats, times: NDArray[np.int64]) -> Floats:
    """Return the positions (k, 5) at times (k,) [ns], between the two samples around each, from samples (n, 5)."""
    since = (stamps - stamps[0]).astype(np.float64)
    return np.stack([np.interp(times - stamps[0], since, column) for column in position.T], axis=1)


def _frames(stamps: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the stamps [ns] of the frames, evenly spread over the run."""
    duration = float(stamps[-1] - stamps[0]) * 1e-9
    count = min(MOST_FRAMES, max(2, math.ceil(duration * RATE) + 1))
    return np.linspace(stamps[0], stamps[-1], count).astype(np.int64)


def _reachable(kinematics: RobotKinematics, q: Floats, frames: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """Leave out frames whose positions no pose belongs to."""
    _, tips = kinematics.transform_tip_to_base_batch(q)
    there = np.isfinite(tips).all(axis=1)
    if there.sum() < 2:
        raise ViewError("the recorded positions fit no pose of this robot", remedy="name the robot with --robot")
    return q[there], frames[there]


def _held(stamps: NDArray[np.int64], frames: NDArray[np.int64]) -> NDArray[np.intp]:
    """Return, by frame, the row of the newest sample that is not later."""
    return np.clip(np.searchsorted(stamps, frames, side="right") - 1, 0, None)


def _sampled(run: Run, topic: str, column: str, frames: NDArray[np.int64], width: int) -> Floats:
    """Return a column (n, width) at the frames, zero where the run lacks it."""
    values = getattr(run[topic], column) if topic in run and len(run[topic]) else None
    if values is None:
        return np.zeros((len(frames), width))
    return np.nan_to_num(values[_held(run[topic].stamp, frames)][:, :width])


def _force(run: Run, frames: NDArray[np.int64]) -> Floats:
    try:
        stamp, force, _ = force_in_base(run)
    except Sher3Error:
        return np.zeros((len(frames), 3))
    return np.nan_to_num(force[_held(stamp, frames)]) if len(stamp) else np.zeros((len(frames), 3))


def _speed(run: Run, frames: NDArray[np.int64]) -> Floats:
    if "measured_cp" not in run or len(run["measured_cp"]) < 2:
        return np.zeros(len(frames))
    speed = np.linalg.norm(tip_velocity(run), axis=1)
    return np.nan_to_num(speed[_held(run["measured_cp"].stamp, frames)])


def _tracking(run: Run, frames: NDArray[np.int64]) -> tuple[str, Floats]:
    """Return which error it is and its values (n, 5): of the position in position modes, else of the velocity.

    The integral of the demand is not used: one lost sample would shift it for the rest of the film.
    """
    for kind, error in (("position", position_error(run)), ("velocity", velocity_error(run))):
        if error is not None and len(error.stamp):
            return kind, error.values[_held(error.stamp, frames)]
    return "velocity", np.full((len(frames), 5), math.nan)


def _settings(run: Run, frames: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return the settings of the motion node in force at each frame; empty ones where they were not recorded."""
    if "motion/settings" not in run or not len(run["motion/settings"]):
        return [{}] * len(frames)
    table = run["motion/settings"]
    texts = [_json(text) for text in table.data]
    return [texts[row] for row in _held(table.stamp, frames)]


def _cap(run: Run, frames: NDArray[np.int64]) -> Floats:
    """Return the speed cap of the regime in force [m/s]; see `sher3_control.motion.speed_cap`."""
    keys = {"near_tissue": "near_speed", "free": "free_speed"}
    caps = []
    for found in _settings(run, frames):
        key = keys.get(str(found.get("regime")))
        caps.append(float(found.get("settings", {}).get(key, math.inf)) if key else math.inf)
    return np.array(caps)


def _remote_centre(run: Run, frames: NDArray[np.int64]) -> Floats:
    """Return the remote centre (n, 3) [m] in {b}, NaN where there was none."""
    centres = np.full((len(frames), 3), math.nan)
    for row, found in enumerate(_settings(run, frames)):
        if found.get("rcm") is not None:
            centres[row] = np.asarray(found["rcm"], dtype=float)[:3]
    return centres


def _spans(run: Run, topics: tuple[str, ...]) -> list[Span]:
    """Return the times of equal state and reason, of the first topic that was recorded."""
    topic = next((name for name in topics if name in run and len(run[name])), None)
    if topic is None:
        return []
    spans: list[Span] = []
    ends = [*run[topic].stamp[1:], run.end]
    for start, end, text in zip(run[topic].stamp, ends, run[topic].data, strict=True):
        status = _json(text)
        state = str(status.get("state") or status.get("reason") or text)
        reason = str(status.get("text") or status.get("reason") or "")
        begin, close = ((int(stamp) - run.start) * 1e-9 for stamp in (start, end))
        if spans and spans[-1][2:] == (state, reason):
            spans[-1] = spans[-1]._replace(end=close)
        else:
            spans.append(Span(begin, close, state, reason))
    return spans


def _json(text: str) -> dict[str, Any]:
    """Return the object of a status text; empty for a plain word or a damaged one."""
    try:
        data = parse_json(text)
    except Sher3Error:
        return {}
    return data if isinstance(data, dict) else {}


def _dropped(run: Run) -> int:
    counts = [_json(entry).get("dropped", 0) for entry in run.records.get("sher3.recording", {}).values()]
    return sum(int(count) for count in counts)
