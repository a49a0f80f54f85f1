"""One axis between two demands: drive, motor side and, when it is compliant, load side, by classical Runge-Kutta.

Recorded-run contract section 3 with every fault at zero; the memory of friction is advanced after each step.
"""

from __future__ import annotations

import math
from typing import Any

from sher3_challenge.plants.compiled import compiled_inner
from sher3_challenge.plants.lumped.hysteresis import drag_anchors, slip_state
from sher3_challenge.plants.lumped.parameters import Array, Drive, Motor, Transmission

STEP = 2.0e-4
TWO_PI = 2 * math.pi

# Classical Runge-Kutta: how far each stage reaches into the step, and its weight.
REACHES = (0.0, 0.5, 0.5, 1.0)
WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
NO_RATES = (0.0,) * 7

# State of one axis.
Q, V, XI, DEMAND, CURRENT, LOAD_Q, LOAD_V = range(7)
STATES = 7

Rates = tuple[float, float, float, float, float, float, float]


@compiled_inner
def drive_force(d: Drive, demand: float, v: float, xi: float, time: float) -> tuple[float, float]:
    """Return the force the drive asks for and the rate of its integrator."""
    error = demand - v
    kp = d.kp * (1.0 + d.asymmetry * (1.0 if error > 0 else -1.0))
    raw = kp * error + d.ki * xi
    limit = d.limit
    rate = error - d.leak * xi
    force = raw
    if raw > limit:
        force = limit
        rate = min(rate, 0.0)
    elif raw < -limit:
        force = -limit
        rate = max(rate, 0.0)
    if d.hum != 0.0:
        force += d.hum * math.sin(TWO_PI * d.hum_frequency * time)
    return force, rate


@compiled_inner
def dead(d: Drive, demand: float) -> float:
    """Return the demand behind the drive's deadband."""
    width = d.deadband
    if width == 0.0:
        return demand
    if abs(demand) <= width:
        return 0.0
    return demand - math.copysign(width, demand) if d.deadband_soft > 0.0 else demand


@compiled_inner
def friction_level(m: Motor, q: float, v: float, time: float) -> float:
    """Return the friction force of full slip (Stribeck curve, position wave, fading, sticky region)."""
    level = m.coulomb
    if m.static != m.coulomb:
        level += (m.static - m.coulomb) * math.exp(-((v / m.stribeck_velocity) ** 2))
    if m.friction_wave != 0.0:
        level += 0.5 * m.friction_wave * (1 + math.sin(TWO_PI * q / m.friction_period + m.friction_phase))
    if m.friction_fading != 0.0:
        level += m.friction_fading * math.exp(-time / m.friction_time)
    if m.sticky != 0.0:
        x = (q - m.sticky_place) / m.sticky_width
        level += m.sticky / (1 + x**4)
    return level


@compiled_inner
def motor_bent(m: Motor, q: float, v: float) -> float:
    """Return the factor by which the motor side's laws differ from their pages."""
    return 1.0 + m.bend * math.sin(m.bend_rate * q + m.bend_quick * v + m.bend_phase)


@compiled_inner
def motor_force(m: Motor, q: float, v: float, force: float, time: float, slip: Array, cable: Array) -> float:
    """Return what accelerates the motor side, external load left out.

    The anchors `slip` and `cable` are (4,) each.
    """
    gain = 1.0
    if m.loss != 0.0:
        gain *= max(0.3, 1 - m.loss * max(0.0, abs(v) / m.loss_velocity - 1.0))
    gain *= 1.0 + (m.torque_gain - 1.0) * motor_bent(m, q, v)
    total = (m.own_viscous - m.viscous) * v - m.weight
    total -= friction_level(m, q, v, time) * slip_state(q, slip, m.presliding)
    if m.cogging != 0.0:
        total -= m.cogging * math.sin(TWO_PI * m.cogging_order * q / m.lead + m.cogging_phase)
    if m.cable != 0.0 or m.cable_loop != 0.0:
        total -= m.cable * (q - m.cable_rest) + m.cable_loop * slip_state(q, cable, m.cable_reach)
    if m.quadratic != 0.0:
        total -= m.quadratic * v * abs(v)
    total *= motor_bent(m, q, v)
    if m.wander != 0.0:
        total -= m.wander * math.sin(TWO_PI * m.wander_frequency * time + m.wander_phase)
    return gain * force - m.own_viscous * v + total


@compiled_inner
def weight_gain(m: Motor, q: float) -> float:
    """Return the real weight of an axis over the modelled one at `q`."""
    return 1.0 + (m.gravity_gain - 1.0) * motor_bent(m, q, 0.0)


@compiled_inner
def inertia(m: Motor, q: float) -> float:
    """Return the moving mass at `q`."""
    mass = m.own_mass + (m.mass - m.own_mass) * motor_bent(m, q, 0.0)
    if m.mass_wave == 0.0:
        return mass
    return mass + m.mass_wave * math.sin(TWO_PI * q / m.mass_period)


@compiled_inner
def bent(t: Transmission, q: float) -> float:
    """Return the factor by which the transmission's laws differ from their pages at `q`."""
    return 1.0 + t.bend * math.sin(t.bend_rate * q + t.bend_phase)


@compiled_inner
def input_position(t: Transmission, q: float) -> float:
    """Return where the motor would put a rigid load: ratio and ripple, without lost motion."""
    x = t.lead_error * q
    if t.ripple != 0.0:
        x += t.ripple * math.sin(TWO_PI * t.ripple_order * q / t.lead + t.ripple_phase)
    return q + x * bent(t, q)


@compiled_inner
def rates(
    m: Motor, d: Drive, t: Transmission, y: Any, demand: float, load: float, time: float, slip: Array, cable: Array
) -> Rates:
    """Return the time derivative of the state `y` (7,) of an axis under a held demand and a load force."""
    q, v, xi, lagged, current, load_q, load_v = y
    held = dead(d, demand)
    lagged_rate = 0.0
    if d.demand_lag > 0.0:
        lagged_rate = (held - lagged) / d.demand_lag
        held = lagged
    force, xi_rate = drive_force(d, held, v, xi, time)
    current_rate = 0.0
    if d.current_lag > 0.0:
        current_rate = (force - current) / d.current_lag
        force = current
    total = motor_force(m, q, v, force, time, slip, cable)
    mass = inertia(m, q)
    if t.compliance == 0.0:
        return v, (total - load) / mass, xi_rate, lagged_rate, current_rate, 0.0, 0.0
    load_mass = t.load_share * mass
    stiffness = 1.0 / (t.compliance * (1 + t.compliance_slope * q) * bent(t, q))
    damping = 0.08 * math.sqrt(stiffness * load_mass)
    spring = stiffness * (input_position(t, q) - load_q) + damping * ((1 + t.lead_error) * v - load_v)
    return (
        v, (total - spring) / (mass - load_mass), xi_rate, lagged_rate, current_rate,
        load_v, (spring - load) / load_mass,
    )  # fmt: skip


@compiled_inner
def shifted(y: Any, k: Any, h: float) -> Rates:
    """Return y + h k."""
    return (
        y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3],
        y[4] + h * k[4], y[5] + h * k[5], y[6] + h * k[6],
    )  # fmt: skip


@compiled_inner
def advance(
    m: Motor, d: Drive, t: Transmission, state: Array, demand: float, load: Array,
    time: float, duration: float, slip: Array, cable: Array,
) -> None:  # fmt: skip
    """Advance `state` (7,) of an axis by `duration` [s] from `time`; `load` is (force at time 0, its rate)."""
    steps = max(1, math.ceil(duration / STEP - 1e-9))
    h = duration / steps
    y = (state[0], state[1], state[2], state[3], state[4], state[5], state[6])
    for _ in range(steps):
        begin, k = y, NO_RATES
        for stage in range(4):  # one call site keeps the compiled code, and its compilation, small
            at = REACHES[stage] * h
            k = rates(m, d, t, shifted(begin, k, at), demand, load[0] + load[1] * (time + at), time + at, slip, cable)
            y = shifted(y, k, WEIGHTS[stage] * h)
        time += h
        drag_anchors(y[0], slip, m.presliding)
        drag_anchors(y[0], cable, m.cable_reach)
    for i in range(STATES):
        state[i] = y[i]


@compiled_inner
def reported_force(d: Drive, state: Array, demand: float, time: float) -> float:
    """Return the force the drive reports at a state (7,): what it makes now, before a new demand acts."""
    if d.current_lag > 0.0:
        return state[CURRENT]
    held = state[DEMAND] if d.demand_lag > 0.0 else dead(d, demand)
    return drive_force(d, held, state[V], state[XI], time)[0]
