"""Dynamics of one axis over one control period: demand queue, drive, motor, friction, transmission (compiled).

Exponential integrator: the linear part (drive PI, mass, viscous friction, lag of the force) is advanced by its exact
matrix exponential. Every other force is held over a step at its value in the middle of the step, where the state of the
bristle is computed (leapfrog). One step per period is exact for the nominal axis; with other forces the error is of
second order in the step.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_common.laws import EARLIER, MEMORY, MOST_FACTORS

from sher3_sim.found import (
    AXIS_QUANTITIES,
    AXIS_TERMS,
    DEMAND,
    DRIVE,
    EFFORT,
    LAW,
    MOTOR,
    PASSED_ON,
    POSITION,
    VELOCITY,
    total,
)
from sher3_sim.parameters import Records

PENDING = 64
"""Largest number of demands that can be under way to one drive."""
FINER = 16
"""Parts into which a step is divided when the drive begins or ceases to saturate within it."""

AXIS_STATE = np.dtype(
    [
        *((name, "f8") for name in ("position", "velocity", "integral", "force", "demand", "echo")),
        *((name, "f8") for name in ("bristle", "cable", "base", "hysteresis", "load", "effort_load")),
        *((name, "f8") for name in ("given", "giving", "pace")),
        ("disturbance", "f8"),
        ("found_inputs", "f8", len(AXIS_QUANTITIES)),
        ("found_last", "f8", (AXIS_TERMS, MOST_FACTORS)),
        ("found_memory", "f8", (AXIS_TERMS, MOST_FACTORS, MEMORY)),
        ("found_past", "f8", (len(PASSED_ON), max(EARLIER))),
        *((name, "f8") for name in ("found_effort", "found_velocity")),
        ("pending", "i8"),
        ("pending_time", "f8", PENDING),
        ("pending_value", "f8", PENDING),
    ]
)
TWO_PI = 2.0 * math.pi


def propagators(axis: Records, step: float) -> NDArray[np.float64]:
    """Return (5, 2, 2, 4, 5): for each axis, step and step / FINER, unsaturated and saturated, the exact linear step.

    The rows give (v, I, F) at the end of the step and the distance travelled, the columns multiply (v, I, F) at its
    beginning and the inputs (u, D). I = ki xi is the integral force, F the force behind the lag, D the sum of the other
    forces, u the demand v_d, or the limiting force when saturated:
    m v' = K F - b v - D, I' = ki (v_d - v) (frozen when saturated), lag F' = kp (v_d - v) + I - F, or = u - F.
    """
    out = np.zeros((len(axis), 2, 2, 4, 5))
    for i, a in enumerate(axis):
        for saturated in (0, 1):
            rates = _rates(a, bool(saturated))
            for j, h in enumerate((step, step / FINER)):
                out[i, j, saturated] = _exact_step((rates * h).tobytes())
    return out


@lru_cache(maxsize=4096)
def _exact_step(rates: bytes) -> NDArray[np.float64]:
    """Return the used part (4, 5) of the matrix exponential, remembered: runs of one robot use few of them."""
    from scipy.linalg import expm  # slow to import, and not needed before a case is read

    return expm(np.frombuffer(rates).reshape(6, 6))[:4, [0, 1, 2, 4, 5]]


def _rates(a: Any, saturated: bool) -> NDArray[np.float64]:
    """Return (6, 6) d/dt of (v, I, F, distance, u, D) as a matrix on the same."""
    law = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0] if saturated else [-a["kp"], 1.0, 0.0, 0.0, a["kp"], 0.0])
    lagged = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    rates = np.zeros((6, 6))
    force = law
    if a["lag"] > 0.0:
        force = lagged
        rates[2] = (law - lagged) / a["lag"]
    rates[0] = (a["torque_scale"] * force - [a["viscous"], 0.0, 0.0, 0.0, 0.0, 1.0]) / a["mass"]
    rates[3, 0] = 1.0
    if not saturated:
        rates[1] = [-a["ki"], 0.0, 0.0, 0.0, a["ki"], 0.0]
    return rates


@compiled
def send(s: Any, value: float, latency: float) -> None:
    """Queue a demand that the drive will act on `latency` seconds into the coming period; order is kept."""
    n = s.pending
    if n == PENDING:
        return
    if n > 0 and s.pending_time[n - 1] > latency:
        latency = s.pending_time[n - 1]
    s.pending_time[n] = latency
    s.pending_value[n] = value
    s.pending = n + 1


@compiled
def _drop_executed(s: Any, executed: int, period: float) -> None:
    for j in range(executed, s.pending):
        s.pending_time[j - executed] = s.pending_time[j] - period
        s.pending_value[j - executed] = s.pending_value[j]
    s.pending -= executed


@compiled
def dead_zone(a: Any, demand: float) -> float:
    """Return the demand the drive acts on: zero inside its dead zone."""
    return 0.0 if abs(demand) < a.deadband else demand


@compiled
def sliding_friction(a: Any, q: float, v: float, time: float) -> float:
    """Friction level g(v) [N] of steady sliding: Coulomb, Stribeck, modulated along the lead, decaying with time."""
    level = a.coulomb
    if a.static > a.coulomb:
        level += (a.static - a.coulomb) * math.exp(-((v / a.stribeck_velocity) ** 2))
    if a.friction_decaying != 0.0:
        level += a.friction_decaying * math.exp(-time / a.friction_decay_time)
    if a.friction_amplitude != 0.0:
        level += a.friction_amplitude * math.cos(TWO_PI * a.friction_periods * q / a.lead + a.friction_phase)
    return max(level, 0.0)


@compiled
def bristle_step(z: float, distance: float, scale: float) -> float:
    """Advance a bristle over a travelled distance, exactly: z' = v - |v| z / scale (Dahl 1968)."""
    end = math.copysign(scale, distance)
    return end + (z - end) * math.exp(-abs(distance) / scale)


@compiled
def drive_force(a: Any, s: Any) -> float:
    """Force the drive exerts now [N], before a new demand acts; what it reports as effort, without noise."""
    if a.lag > 0.0:
        return s.force + s.found_effort
    return min(max(a.kp * (dead_zone(a, s.demand) - s.velocity) + s.integral, -a.limit), a.limit) + s.found_effort


@compiled
def _found_force(a: Any, s: Any, position: float, velocity: float, demand: float, h: float) -> float:
    """Return what discovered formulas resist with over a step [N]; what they add to the drive's effort is kept."""
    x = s.found_inputs
    x[POSITION], x[VELOCITY], x[DEMAND] = position, velocity, demand
    x[EFFORT], x[LAW] = drive_force(a, s), a.kp * (demand - velocity) + s.integral
    s.found_effort = total(a.found, DRIVE, x, s.found_last, s.found_memory, h)
    return total(a.found, MOTOR, x, s.found_last, s.found_memory, h) - a.torque_scale * s.found_effort


@compiled
def linear_step(
    a: Any, maps: Any, v: float, integral: float, force: float, demand: float, other: float, h: float
) -> tuple[float, float, float, float]:
    """Advance drive and motor by a step under a constant demand and load, saturated throughout or not at all.

    Returns:
        Distance travelled, and velocity, integral force and lagged force at the end.
    """
    wanted = a.kp * (demand - v) + integral
    saturated = abs(wanted) > a.limit
    m = maps[1] if saturated else maps[0]
    u = math.copysign(a.limit, wanted) if saturated else demand
    v_end = m[0, 0] * v + m[0, 1] * integral + m[0, 2] * force + m[0, 3] * u + m[0, 4] * other
    i_end = m[1, 0] * v + m[1, 1] * integral + m[1, 2] * force + m[1, 3] * u + m[1, 4] * other
    f_end = m[2, 0] * v + m[2, 1] * integral + m[2, 2] * force + m[2, 3] * u + m[2, 4] * other
    moved = m[3, 0] * v + m[3, 1] * integral + m[3, 2] * force + m[3, 3] * u + m[3, 4] * other
    error = demand * h - moved
    if saturated and error * wanted < 0.0:
        i_end += a.ki * error
    return moved, v_end, i_end, f_end


@compiled
def advance(a: Any, s: Any, step_maps: Any, load: float, time: float, period: float, substeps: int) -> None:
    """Advance one axis over one control period under a constant load.

    Args:
        a: AXIS record of the axis.
        s: AXIS_STATE record of the axis, changed in place.
        step_maps: Propagators of the axis for `period / substeps`, (2, 2, 4, 5).
        load: Gravity less contact force along the axis [N], positive against positive motion.
        time: Time since the start of the run [s].
        period: Control period [s].
        substeps: Steps in the period.
    """
    h = period / substeps
    q, v, integral, force = s.position, s.velocity, s.integral, s.force
    demand, executed, echo = s.demand, 0, 0.0
    rubs = a.coulomb > 0.0 or a.static > 0.0 or a.friction_decaying > 0.0 or a.friction_amplitude > 0.0
    for j in range(substeps):
        # mean demand of the step: raw for the echo, behind the dead zone for the drive
        begin, end = j * h, (j + 1) * h
        raw, acted, now = 0.0, 0.0, begin
        while executed < s.pending and s.pending_time[executed] < end:
            change = max(s.pending_time[executed], now)
            raw += demand * (change - now)
            acted += dead_zone(a, demand) * (change - now)
            demand, now = s.pending_value[executed], change
            executed += 1
        raw += demand * (end - now)
        acted = (acted + dead_zone(a, demand) * (end - now)) / h
        echo += raw

        middle = q + 0.5 * h * v
        other = load
        if rubs:
            level = sliding_friction(a, middle, v, time + begin)
            s.bristle = bristle_step(s.bristle, h * v, a.displacement)
            other += level * s.bristle / a.displacement
        if a.cogging_amplitude != 0.0:
            other += a.cogging_amplitude * math.sin(TWO_PI * a.cogging_periods * middle / a.lead + a.cogging_phase)
        if a.cable_displacement > 0.0:
            s.cable = bristle_step(s.cable, h * v, a.cable_displacement)
            other += a.cable_stiffness * middle + a.cable_force * s.cable / a.cable_displacement
        if a.found_any:
            other += _found_force(a, s, middle, v, acted, h)

        begins = abs(a.kp * (acted - v) + integral) > a.limit
        moved, v_end, i_end, f_end = linear_step(a, step_maps[0], v, integral, force, acted, other, h)
        if begins != (abs(a.kp * (acted - v_end) + i_end) > a.limit):
            # the drive begins or ceases to saturate within the step: find out when
            moved, v_end, i_end, f_end = 0.0, v, integral, force
            for _ in range(FINER):
                part, v_end, i_end, f_end = linear_step(a, step_maps[1], v_end, i_end, f_end, acted, other, h / FINER)
                moved += part
        q, v, integral, force = q + moved, v_end, i_end, f_end
    s.position, s.velocity, s.integral, s.force = q, v, integral, force
    s.demand, s.echo = demand, echo / period
    _drop_executed(s, executed, period)
