"""One axis in continuous time: drive, motor side, transmission, by Strang splitting.

The parts `m d o t` are those of one axis: numbers and its tables (`axis_slice`).

Half a drift (positions and memories move, speeds are held), a kick (speeds change, positions are held; the drive's
damping is integrated exactly), half a drift. Second order, and stable for the drive's fastest pole at any step.
"""

from __future__ import annotations

import math

from sher3_challenge.plants.compiled import compiled_inner
from sher3_challenge.plants.plant import Array
from sher3_challenge.plants.tables.curves import around, at, crept
from sher3_challenge.plants.tables.parameters import PLACES, SPEEDS, Drive, Motor, Odd, Transmission

(Q, V, XI, POLE, FORCE, X1, W1, X2, W2, STUCK, CABLE, LOOP, DETENT, REST, TURN, SNAP, HEAT, MOUNT_Q, MOUNT_V, CLAMP) = (
    range(20)
)
STATES = 20
"""Motor position and speed, integrator, force behind one and two poles, load and carriage with their speeds, states of
hysteresis, rest, travel since reversal, side of a snapping cable, warmth, payload on its mount, side of the clamp."""

REST_TIME, REST_TRAVEL = 0.3, 0.13
"""Time in which a lubricant settles [s]; travel that stirs it again, as a part of `span`."""
WARM_TIME = 1.5
"""Time constant of a winding [s]."""
STILL = 0.01
"""Share of the top speed below which an axis rests."""
MATERIAL_DAMPING = 0.12
"""Damping ratio of contacts and springs of the transmission."""


@compiled_inner
def friction_level(m: Motor, q: float, v: float) -> float:
    """Return the friction of full slip from the map of the direction of travel, linear in both coordinates."""
    way = 1 if v > 0.0 else 0
    u = math.sqrt(min(1.0, abs(v) / m.top)) * (SPEEDS - 1)
    a = min(int(u), SPEEDS - 2)
    s = u - a
    turns = q / m.span
    w = (turns - math.floor(turns)) * PLACES
    b = int(w) % PLACES
    t, c = w - int(w), (b + 1) % PLACES
    table = m.friction[way]
    low = table[a, b] + t * (table[a, c] - table[a, b])
    high = table[a + 1, b] + t * (table[a + 1, c] - table[a + 1, b])
    return low + s * (high - low)


@compiled_inner
def bent(m: Motor, q: float, v: float) -> float:
    """Return the factor by which the laws of an axis differ from their pages at a position and speed."""
    return 1.0 + m.bend * math.sin(m.bend_rate * q + m.bend_quick * v + m.bend_phase)


@compiled_inner
def driven(t: Transmission, m: Motor, q: float) -> float:
    """Return where the motor would put a load without lost motion: ratio, error along the stroke and by turn."""
    return q + bent(m, q, 0.0) * (t.ratio * q + around(t.wave, q / m.span) + around(t.ripple, q / m.lead))


@compiled_inner
def demand_taken(d: Drive, demand: float) -> float:
    """Return what the drive follows: small demands do nothing, with a rounded edge a fifth of the band wide."""
    if d.band == 0.0:
        return demand
    u = (abs(demand) / d.band - 0.9) / 0.2
    if u <= 0.0:
        return 0.0
    return demand if u >= 1.0 else demand * u * u * (3.0 - 2.0 * u)


@compiled_inner
def pushed(d: Drive, raw: float) -> tuple[float, float]:
    """Return the force of a drive that is asked for `raw`, and the side on which it is clamped or 0."""
    limit = d.limit
    if abs(raw) <= 0.8 * limit or (d.soft == 0.0 and abs(raw) <= limit):
        return raw, 0.0
    side = 1.0 if raw > 0.0 else -1.0
    if d.soft == 0.0:
        return side * limit, side
    over = min(1.0, (abs(raw) / limit - 0.8) / 0.4)
    return side * limit * (0.8 + 0.4 * over - 0.2 * over * over), side if over >= 1.0 else 0.0


@compiled_inner
def drive_force(d: Drive, o: Odd, m: Motor, y: Array, demand: float) -> tuple[float, float, float]:
    """Return the force the drive asks for at a state (20,), how it falls with speed, and the side of its clamp."""
    v = y[V]
    kp = d.kp * (1.0 - o.schedule * min(1.0, abs(v) / m.top))
    raw = kp * (demand_taken(d, demand) - v) + d.ki * y[XI]
    force, side = pushed(d, raw)
    if o.crossover > 0.0:
        swallowed = o.crossover
        force = math.copysign(max(0.0, abs(force) - swallowed), force) if abs(force) < 6 * swallowed else force * 5 / 6
    return force, kp if force == raw else 0.0, side


@compiled_inner
def motor_resistance(m: Motor, o: Odd, y: Array, time: float) -> float:
    """Return what resists the motor at a state (20,), by position, direction and past; viscous friction left out."""
    q, v = y[Q], y[V]
    level = friction_level(m, q, v) + at(m.fading, time / m.fading_end)
    if o.resting != 0.0:
        level += o.resting * y[REST]
    if o.plough != 0.0:
        level += o.plough * min(1.0, y[TURN] / o.plough_reach)
    total = level * y[STUCK] + m.weight + around(m.cogging, q / m.lead)
    if m.cable_loop != 0.0:
        total += at(m.cable, 0.5 + 0.5 * (q - m.cable_rest) / m.cable_span) + m.cable_loop * y[CABLE]
    if o.detent != 0.0:
        total += o.detent * math.sin(2 * math.pi * o.detent_order * q / m.lead + 1.2 * y[DETENT])
    return total * bent(m, q, v) + o.snap * y[SNAP]


@compiled_inner
def reported_force(d: Drive, o: Odd, m: Motor, y: Array, demand: float) -> float:
    """Return the force the drive makes now, at a state (20,), before a new demand acts."""
    return y[FORCE] if d.lag > 0.0 else drive_force(d, o, m, y, demand)[0]


@compiled_inner
def drift(m: Motor, d: Drive, o: Odd, t: Transmission, y: Array, demand: float, h: float) -> None:
    """Move positions, the integrator and what remembers the travel, of a state (20,), by `h` [s]."""
    v = y[V]
    dx = h * v
    y[Q] += dx
    error = demand_taken(d, demand) - v
    if y[CLAMP] * error <= 0.0:
        y[XI] += h * error
    y[X1] += h * y[W1]
    y[X2] += h * y[W2]
    slope = m.slope
    if t.hysteresis != 0.0:
        y[LOOP] = crept(y[LOOP], dx, t.hysteresis_reach, slope)
    y[STUCK] = crept(y[STUCK], dx, m.reach, slope)
    if m.cable_loop != 0.0:
        y[CABLE] = crept(y[CABLE], dx, m.cable_reach, slope)
    if m.mount_mass != 0.0:
        y[MOUNT_Q] += h * y[MOUNT_V]
    if o.detent != 0.0:
        y[DETENT] = crept(y[DETENT], dx, 0.05 * m.lead, slope)
    if o.resting != 0.0:
        settle = h / REST_TIME * (1.0 - y[REST]) if abs(v) < STILL * m.top else 0.0
        y[REST] += settle - min(1.0, abs(dx) / (REST_TRAVEL * m.span)) * y[REST]
    if o.plough != 0.0 and dx != 0.0:
        y[TURN] = y[TURN] + abs(dx) if dx * y[STUCK] > 0.0 else 0.0
    if o.snap != 0.0:
        beyond = (y[Q] - o.place) / o.snap_width
        y[SNAP] = -1.0 if beyond > 1.0 else (1.0 if beyond < -1.0 else y[SNAP])


@compiled_inner
def spring(m: Motor, t: Transmission, q: float, pull: float) -> float:
    """Return the force of the transmission at `q` for a wind-up `pull`: the stiffness is a table over the force."""
    stiffness = 1.0 / t.compliance
    return stiffness * pull * at(t.stiffening, abs(stiffness * pull) / m.full) / bent(m, q, 0.0)


@compiled_inner
def carried(t: Transmission, y: Array, ahead: float, speed: float, h: float) -> float:
    """Kick the carriage of a state (20,) behind the gap, its input at `ahead`; return the force on what drives it."""
    reach = ahead - y[X2]
    into = abs(reach) - 0.5 * t.gap
    force = 0.0
    if into > 0.0:
        way = 1.0 if reach > 0.0 else -1.0
        damping = 2 * MATERIAL_DAMPING * math.sqrt(t.contact * t.carriage)
        force = way * t.contact * into + damping * (speed - y[W2])
        force = max(0.0, force * way) * way  # a contact does not pull
    free = y[W2] + h * force / t.carriage
    held = h * t.brake / t.carriage
    y[W2] = math.copysign(max(0.0, abs(free) - held), free)
    return force


@compiled_inner
def kick(
    m: Motor, d: Drive, o: Odd, t: Transmission, y: Array, demand: float, load: float, time: float, h: float
) -> None:
    """Change the speeds of a state (20,) over `h` [s] under a demand and a load force, positions being held."""
    v = y[V]
    force, falls, y[CLAMP] = drive_force(d, o, m, y, demand)
    if d.lag > 0.0:
        keep = d.lag / (d.lag + 2.0 * h)  # so that slow changes are late by `lag`, whatever the step
        y[POLE] = force + keep * (y[POLE] - force)
        y[FORCE] = y[POLE] + keep * (y[FORCE] - y[POLE])
        force, falls = y[FORCE], 0.0
    gain = 1.0 + (at(m.force_gain, abs(force) / m.full) - 1.0) * bent(m, y[Q], v)
    if o.heat != 0.0:
        y[HEAT] += h / WARM_TIME * ((force / (0.2 * d.rated)) ** 2 - y[HEAT])
        gain *= 1.0 - o.heat * min(1.0, y[HEAT])
    viscous = m.own_viscous + (m.viscous - m.own_viscous) * bent(m, y[Q], v)
    total = gain * force - viscous * v - motor_resistance(m, o, y, time)
    mass = m.mass
    if o.engaged != 0.0:
        mass += o.engaged * min(1.0, max(0.0, 0.5 + (y[Q] - o.place) / (0.05 * m.span)))
    if m.mount_mass != 0.0:
        pull = m.mount_stiffness * (y[MOUNT_Q] - y[Q]) + m.mount_damping * (y[MOUNT_V] - v)
        total += pull
        y[MOUNT_V] -= h * (pull + m.mount_weight) / m.mount_mass
    elastic, gap = t.compliance > 0.0, t.gap > 0.0
    if elastic or gap:
        input_q, input_v = driven(t, m, y[Q]), (1.0 + t.ratio) * v
    if elastic:
        behind = t.share * mass
        damping = 2 * MATERIAL_DAMPING * math.sqrt(behind / t.compliance)
        wound = spring(m, t, y[Q], input_q - y[X1]) + damping * (input_v - y[W1])
        back = carried(t, y, y[X1], y[W1], h) if gap else 0.0
        y[W1] += h * (wound - load - back) / behind
        total -= wound
        mass -= behind
    else:
        total -= load
        if gap:
            total -= carried(t, y, input_q, input_v, h)
    resists = gain * falls + m.viscous
    share = h * resists / mass
    y[V] = v + total / resists * -math.expm1(-share) if share > 1e-9 else v + h * total / mass


@compiled_inner
def load_position(m: Motor, o: Odd, t: Transmission, y: Array) -> float:
    """Return the true position of the load at a state (20,)."""
    if t.gap > 0.0:
        x = y[X2]
    elif t.compliance > 0.0:
        x = y[X1]
    else:
        x = driven(t, m, y[Q])
    if o.joint != 0.0:
        u = min(1.0, max(0.0, 0.5 + (x - o.place) / o.joint_width))
        x += o.joint * u * u * (3.0 - 2.0 * u)
    return x - t.hysteresis * bent(m, y[Q], 0.0) * y[LOOP]


@compiled_inner
def advance(
    m: Motor, d: Drive, o: Odd, t: Transmission, y: Array, demands: Array, load: float, time: float, h: float
) -> None:
    """Advance the state (20,) of an axis in steps of `h` [s] under a demand for each step and one load force."""
    for i in range(len(demands)):
        drift(m, d, o, t, y, demands[i], 0.5 * h)
        kick(m, d, o, t, y, demands[i], load, time + (i + 0.5) * h, h)
        drift(m, d, o, t, y, demands[i], 0.5 * h)
