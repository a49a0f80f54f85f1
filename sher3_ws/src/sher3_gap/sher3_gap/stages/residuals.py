"""Residuals of the continuous stages: drive, motor mechanics, transmission, mechanism, structure, sensing.

Each function takes a run and the nominal model and returns {channel: Residual}. The exact stages (transport,
controller) are in `exact.py`. Equations: recorded-run contract §3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel, Residual, Residuals
from sher3_diagnosis.filter import settled

from sher3_gap.signals import RunSignals
from sher3_gap.stages.geometry import Geometry, changing

ZEROS_FREE = 0.96
"""Share of a run's mean encoder difference that is taken off: the zeros of two encoders differ by a share of a count
from run to run. Set on: repeats of the development seeds, whose zeros scatter by five times what the rest of a run
does. Measure: `sher3 gap challenge --kinds healthy`."""
SHORT = 20
"""Samples below which a mean of their own would take most of a gap away."""


@dataclass(frozen=True)
class Demand:
    """The velocity demand a drive held when commands arrive late.

    Attributes:
        velocity: (n, axes) demand in force just before each tick.
        late: (n, axes) share of the period that ends at each tick, after which it changed in it.
    """

    velocity: Array
    late: Array


def drive_law(run: RunSignals, robot: Robot, demand: Array) -> Array:
    """Nominal PI force at each tick for the demand held and the measured motion, (n, axes), up to a constant per axis.

    `demand` (n, axes) is the velocity demand in force just before each tick. The integral of the demand is that of the
    echo (its mean over each interval), the integral of the motion is the encoder itself, so no velocity is integrated.
    """
    assert run.echo is not None
    drive = [a.drive for a in robot.actuators]
    kp, ki = np.array([d.kp for d in drive]), np.array([d.ki for d in drive])
    velocity = np.gradient(run.motor, run.period, axis=0)
    xi = np.cumsum(run.echo, axis=0) * run.period - (run.motor - run.motor[0])
    return kp * (demand - velocity) + ki * xi


def drive_residual(run: RunSignals, robot: Robot, demand: Demand | None = None) -> Residuals:
    """Reported effort minus the PI law. The integrator's start is not recorded: each run's mean is free, and again
    behind each lost tick.
    """
    if run.echo is None or run.effort is None:
        return {}
    values = run.to_grid(run.effort - drive_law(run, robot, run.echo if demand is None else demand.velocity))
    return {Channel("drive", a): centred(values[:, i], run.inner, run.pieces) for i, a in enumerate(ACTUATORS)}


def centred(x: Array, ok: np.ndarray, pieces: np.ndarray) -> Residual:
    """Return the residual (n, 1) of x (n,) less its mean over each piece; one of few valid samples does not count."""
    out, ok = x - x[ok].mean() if ok.any() else x.copy(), ok.copy()
    for piece in np.unique(pieces) if pieces[-1] else ():
        mine = (pieces == piece) & ok
        ok[mine] = mine.sum() >= SHORT
        if mine.any():
            out[mine] = x[mine] - x[mine].mean()
    return Residual(out[:, None], ok, free_mean=1.0)


def mean_force(
    run: RunSignals, robot: Robot, demand: Demand | None = None, steps: bool = True, limit: Array | None = None
) -> Array:
    """Mean motor force around each tick, weighted as the second difference of the position weighs it, (n, axes).

    The reported effort is F just before the demand changes; F then steps by kp * (change of demand), at once or a share
    `late` of the period later. `steps` is False for a drive whose force follows continuously; `limit` (axes,) is the
    force at which it ends.
    """
    assert run.effort is not None
    force = run.effort.copy()
    if run.echo is not None and steps:
        kp = np.array([a.drive.kp for a in robot.actuators])
        held = run.echo if demand is None else demand.velocity
        late = np.zeros(run.axes) if demand is None else demand.late[1:]
        step = kp * np.diff(held, axis=0)
        if limit is not None:
            step = np.clip(force[:-1] + step, -limit, limit) - np.clip(force[:-1], -limit, limit)
        share = step_share(kp / np.array([a.mass for a in robot.actuators]) * run.period)
        force[:-1] += share * (1.0 - late) ** 2 * step
        force[1:] -= (1.0 - share) * late**2 * step
    return force


def step_share(decay: Array) -> Array:
    """Mean share (k,) of a force step that is left over the period in which it relaxes, from 1 to 0.

    The velocity loop relaxes it as exp(-decay u), u in 0..1; one half where it relaxes evenly.
    """
    return 1.0 / decay - 1.0 / np.expm1(decay)


def motor_residual(
    run: RunSignals,
    robot: Robot,
    geometry: Geometry,
    demand: Demand | None = None,
    steps: bool = True,
    limit: Array | None = None,
) -> Residuals:
    """Return the force (g, 1) at each actuator that a nominal rigid axis does not explain, N or N m; positive resists.

    F - m a - viscous v - G(q) + tau_ext. Without an echo there is none: by how much the force stepped at each tick is
    what the demand tells.

    Args:
        run: its signals.
        robot: as specified.
        geometry: of its mechanism.
        demand: velocity demands in force; default the echo.
        steps: whether the force steps with each new command.
        limit: (5,) force at which each drive ends, N or N m.
    """
    if run.effort is None or run.echo is None:
        return {}
    mass = np.array([a.mass for a in robot.actuators])
    viscous = np.array([a.viscous for a in robot.actuators])
    path = geometry.path(run)
    inertial = mass * run.acceleration + viscous * run.velocity
    values = run.to_grid(mean_force(run, robot, demand, steps, limit) - inertial) - path.gravity + path.contact_force
    ok = run.inner & settled(run.loaded_ok)
    return {Channel("motor_mechanics", a): Residual(values[:, [i]], ok) for i, a in enumerate(ACTUATORS)}


def transmission_residual(run: RunSignals) -> Residuals:
    """Load encoder minus motor encoder, low-passed.

    Not while a stated load comes or goes: what gives way under it follows a share of it that nobody states.
    """
    if run.load is None:
        return {}
    values = run.to_grid(run.load - run.motor)
    ok = run.inner & ~np.any(changing(run), axis=(0, 2))
    return {Channel("transmission", a): Residual(values[:, [i]], ok, ZEROS_FREE) for i, a in enumerate(ACTUATORS)}


def tip_residual(run: RunSignals, geometry: Geometry) -> Residuals:
    """Tracked tip pose minus T_bt of the load encoders, split into unloaded (mechanism) and loaded (structure) samples.

    Components: position in {b} (m), then the rotation vector in {b} (rad).
    """
    if run.tracker_position is None or run.tracker_index is None:
        return {}
    values = geometry.tip_error(run)
    path = geometry.path(run)
    at = np.isin(np.arange(len(run.grid)), run.tracker_slot)
    ok = run.inner & run.loaded_ok & at
    loaded = path.loaded
    out = {Channel("mechanism", "tip"): Residual(values, ok & ~loaded)}
    if (ok & loaded).any():
        out[Channel("structure", "tip")] = Residual(values, ok & loaded)
    return out


def wrench_residual(run: RunSignals, geometry: Geometry) -> Residuals:
    """Force sensor reading minus tool gravity and the known contact, in {f}: force (N), torque (N m).

    While a stated load comes or goes its direction is known and its size is not: what disagrees with every size counts.
    """
    if run.wrench is None:
        return {}
    path = geometry.path(run)
    values = run.to_grid(run.wrench) - path.nominal_wrench
    ok = run.inner & settled(run.loaded_ok)
    if path.determined is not None:
        ok |= run.inner & np.any(changing(run), axis=(0, 2))
    return {Channel("sensing", "force_sensor"): Residual(values, ok, determined=path.determined)}


def all_residuals(run: RunSignals, robot: Robot, geometry: Geometry, demand: Demand | None = None) -> Residuals:
    """Residuals of every continuous stage the run has streams for, and samples that count."""
    found = {
        **drive_residual(run, robot, demand),
        **motor_residual(run, robot, geometry, demand),
        **transmission_residual(run),
        **tip_residual(run, geometry),
        **wrench_residual(run, geometry),
    }
    return {channel: residual for channel, residual in found.items() if residual.ok.any()}
