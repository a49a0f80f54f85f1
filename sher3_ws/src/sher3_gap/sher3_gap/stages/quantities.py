"""What was recorded of a run, by the quantities that the law of an effect may depend on."""

from __future__ import annotations

import numpy as np
from sher3_description import ACTUATORS
from sher3_diagnosis.channel import Array
from sher3_effects.view import RobotView

STROKES = (2e-3, 2e-2, 2e-1)
"""Strokes over which the direction of motion is remembered, motor revolutions."""


def quantities(view: RobotView, site: str) -> dict[str, Array]:
    """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns, as a place of the robot feels them."""
    run, path = view.run, view.path
    shared = {
        "posture": posture(view),
        "temperature": view.warmth[:, None],
        "time": np.column_stack([run.stage_clock[run.grid], np.full(len(run.grid), run.session_time)]),
    }
    if site not in ACTUATORS:
        weight = path.tool_wrench if site == "force_sensor" else path.rotation[:, 2]
        load = path.contact_wrench if site == "force_sensor" else path.contact
        return shared | {
            "direction": np.hstack([directions(view, i) for i in range(run.axes)]),
            "acceleration": np.hstack([earlier(run.to_grid(view.tip_acceleration), k) for k in range(RINGS)]),
            "weight": weight,
            "load": load,
            "velocity": view.velocity,
            "position": view.position,
        }
    i = view.row(site)
    q, lead = view.position[:, i], view.lead(site)
    return shared | {
        "position": np.column_stack([q, q / lead % 1.0]),
        "velocity": view.velocity[:, [i]],
        "direction": directions(view, i),
        "acceleration": acceleration(view)[:, [i]],
        "force": view.inertial[:, [i]],
        "weight": path.gravity[:, [i]],
        "load": path.contact_force[:, [i]],
        "command": commands(view, i),
    }


def directions(view: RobotView, axis: int) -> Array:
    """Return (g, 4): sign of the motion, and its memory over three strokes, of one axis."""
    lead = view.robot.actuators[axis].lead
    states = [view.sliding(axis, stroke * lead)[view.run.grid] for stroke in STROKES]
    return np.column_stack([np.sign(np.round(view.velocity[:, axis], 5)), *states])


def acceleration(view: RobotView) -> Array:
    """Return the smoothed acceleration of the motors, (g, axes)."""
    run = view.run
    return np.gradient(run.velocity, run.period, axis=0)[run.grid]


def commands(view: RobotView, axis: int) -> Array:
    """Return (g, k): what the host asked for and what the drive executed, of one axis."""
    run = view.run
    found = [x for x in (run.command, run.echo) if x is not None]
    return np.column_stack([x[run.grid, axis] for x in found]) if found else np.zeros((len(run.grid), 0))


def posture(view: RobotView) -> Array:
    """Return (g, axes) positions of all axes."""
    return view.position


def everything(view: RobotView) -> Array:
    """Return (g, k) everything that was recorded of the whole robot, and of its motion a little earlier."""
    run = view.run
    signs = np.sign(np.round(view.velocity, 5))
    now = [view.position, view.velocity, signs, acceleration(view), view.path.contact, view.warmth[:, None]]
    if run.effort is not None:
        now.append(run.to_grid(run.effort))
    past = [earlier(x, k) for k in LAGS for x in (view.velocity, acceleration(view))]
    return np.hstack([*now, *past])


RINGS = 40
"""Samples of the residual grid over which the tip may ring after it was accelerated: 0.4 s."""
LAGS = (3, 10, 30)
"""Samples of the residual grid by which the past is looked at: 30, 100 and 300 ms."""


def earlier(x: Array, samples: int) -> Array:
    """Return x (g, k) as it was `samples` samples before; before the run began, its first row."""
    return np.concatenate([np.repeat(x[:1], samples, axis=0), x[: len(x) - samples]])
