"""What repeats differ by: the floor below which a gap is no gap.

Per channel and component, F = mean((y_a - y_b)^2) / 2 over pairs of runs with the same excitation (contract §8), but
never less than what the readings' resolution alone makes, which repeats of a robot at rest do not show.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_description.contract import EFFORT_NOISE, EFFORT_RESOLUTION
from sher3_diagnosis.channel import Channel, Floors, Residuals
from sher3_diagnosis.filter import BANDWIDTH
from sher3_diagnosis.localise.floors import UNIFORM, relieved_rms, repeat_floors

from sher3_gap.signals import RunSignals
from sher3_gap.stages.geometry import Geometry

CHATTER_RATE = 12.0
"""Toggles per second of a reading at rest on the edge of a count."""
REST_COUNTS = 8
"""Travel below which an axis is at rest in a run, motor encoder counts."""


def resolution_floors(robot: Robot, period: float) -> Floors:
    """Floor from quantisation and the stated sensor noise alone."""
    share = np.sqrt(min(1.0, 2.0 * BANDWIDTH * period))
    out: Floors = {}
    for name, a in zip(ACTUATORS, robot.actuators, strict=True):
        counts = np.hypot(a.motor_encoder, a.load_encoder) / UNIFORM
        effort = share * a.drive.rated * np.hypot(EFFORT_NOISE, EFFORT_RESOLUTION / UNIFORM)
        out[Channel("transmission", name)] = np.array([counts])
        held = a.drive.ki * a.motor_encoder / UNIFORM
        out[Channel("drive", name)] = np.array([np.hypot(effort, held)])
        out[Channel("motor_mechanics", name)] = np.array([effort])
    tip = np.repeat([robot.tracker.noise_position, robot.tracker.noise_rotation], 3)
    out[Channel("mechanism", "tip")] = tip
    out[Channel("structure", "tip")] = tip
    sensor = robot.force_sensor
    step = np.array([sensor.resolution_force] * 3 + [sensor.resolution_torque] * 3) / UNIFORM
    noise = np.array([sensor.noise_force] * 3 + [sensor.noise_torque] * 3)
    out[Channel("sensing", "force_sensor")] = np.maximum(share * np.hypot(noise, step), step)
    return out


def chatter_floors(run: RunSignals, robot: Robot) -> Floors:
    """Floor of axes at rest whose reading may chatter between two counts: one count toggling at `CHATTER_RATE`.

    A control loop at rest settles on the edge of a count as often as not; which runs do is chance.
    """
    rng = np.random.default_rng(0)
    flips = rng.random(run.ticks) < CHATTER_RATE * run.period
    toggle = np.where(np.cumsum(flips) % 2 == 0, -0.5, 0.5)
    rate = np.gradient(toggle, run.period)
    bend = np.zeros_like(toggle)
    bend[1:-1] = np.diff(toggle, 2) / run.period**2
    grid = {n: run.to_grid(x) for n, x in (("x", toggle), ("v", rate), ("a", bend))}
    out: Floors = {}
    for i, (name, a) in enumerate(zip(ACTUATORS, robot.actuators, strict=True)):
        count = a.motor_encoder
        if np.ptp(run.motor[:, i]) > REST_COUNTS * count:
            continue
        drive = count * (a.drive.kp * grid["v"] + a.drive.ki * grid["x"])
        motor = count * (a.mass * grid["a"] + a.viscous * grid["v"])
        out[Channel("drive", name)] = np.array([drive.std()])
        out[Channel("motor_mechanics", name)] = np.array([motor.std()])
    return out


def averaged(run: RunSignals, robot: Robot, channel: Channel) -> bool:
    """Whether rounding averages out: two encoders that cross many counts in a run; at rest it is an offset."""
    if channel.stage != "transmission":
        return False
    i = ACTUATORS.index(channel.actuator)
    moving = np.abs(np.diff(run.smooth[:, i])) > 0.02 * robot.actuators[i].motor_encoder
    return bool(moving.mean() > 0.5)


def floors(
    runs: Sequence[RunSignals],
    residuals: Sequence[Residuals],
    simulated: Sequence[Sequence[Residuals]],
    robot: Robot,
) -> list[Floors]:
    """Per run the largest of the repeat floor, the resolution floor and the pipeline's own.

    `simulated` are, per run, residuals of the nominal plant on its set-points: what quantisation leaves at rest or at a
    crawl differs from run to run, and no repeat of another excitation shows it.
    """
    least = resolution_floors(robot, runs[0].period)
    repeats = repeat_floors([run.excitation for run in runs], residuals)
    tip, loaded = Channel("mechanism", "tip"), Channel("structure", "tip")
    if loaded not in repeats and tip in repeats:
        repeats[loaded] = repeats[tip]
    out: list[Floors] = []
    for run, found, twins in zip(runs, residuals, simulated, strict=True):
        chatter = chatter_floors(run, robot)
        known = {c: 0.5 * x if averaged(run, robot, c) and any(twins) else x for c, x in least.items()}
        base = {c: np.maximum(repeats.get(c, least[c]), np.hypot(known[c], chatter.get(c, 0.0))) for c in found}
        out.append({c: np.max([b, *(relieved_rms(t[c]) for t in twins if c in t)], axis=0) for c, b in base.items()})
    return out


def with_load(floor: Floors, run: RunSignals, robot: Robot, geometry: Geometry) -> Floors:
    """Add the scatter of the stated tip load, known to a tolerance of three standard deviations from run to run.

    At the force sensor also what the load's direction and place leave open, where the tracker sees the tip elsewhere.
    """
    path, share = geometry.path(run), robot.tolerances.known_load / 3.0
    ok = run.inner & run.loaded_ok
    if not (path.loaded & ok).any():
        return floor
    wrench, force = (share * np.sqrt(np.mean(x[ok] ** 2, axis=0)) for x in (path.contact_wrench, path.contact_force))
    load = {Channel("sensing", "force_sensor"): np.hypot(wrench, astray(run, geometry, path.loaded & ok))}
    load |= {Channel("motor_mechanics", a): force[[i]] for i, a in enumerate(ACTUATORS)}
    return {c: np.hypot(x, load.get(c, 0.0)) for c, x in floor.items()}


def astray(run: RunSignals, geometry: Geometry, loaded: np.ndarray) -> np.ndarray:
    """Return by how much a known load reads otherwise at a tip that is off as the tracker says, N and N m, (6,).

    A tip that turns by an angle turns the load by as much at the sensor, if the sensor turns with it; one that moves
    changes the lever. Nobody states which side of what bends the sensor is on.
    """
    if run.tracker_position is None or run.tracker_index is None:
        return np.zeros(6)
    force, torque, shift, turn = (
        float(np.sqrt(np.mean(np.sum(x[loaded] ** 2, axis=1))))
        for whole in (geometry.path(run).contact_wrench, geometry.tip_error(run))
        for x in (whole[:, :3], whole[:, 3:])
    )
    return np.repeat([turn * force, turn * torque + shift * force], 3)
