"""The closed loop of one run in one compiled call: host, transport, drives, axes, transmission, encoders."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sher3_challenge.plants.arrays import Course, axis_slice
from sher3_challenge.plants.compiled import compiled, compiled_inner
from sher3_challenge.plants.grammar import ON_FORCE, ON_READING, Foreign, foreign
from sher3_challenge.plants.lumped.axis import (
    LOAD_Q,
    LOAD_V,
    STATES,
    XI,
    Q,
    V,
    advance,
    bent,
    input_position,
    motor_bent,
    motor_force,
    reported_force,
    weight_gain,
)
from sher3_challenge.plants.lumped.hysteresis import ELEMENTS, drag_anchors, play_offset, slip_state
from sher3_challenge.plants.lumped.mechanism import load_forces
from sher3_challenge.plants.lumped.parameters import (
    AXES,
    Array,
    Drive,
    Geometry,
    Host,
    Motor,
    Transmission,
    TruthParameters,
)

HISTORY = 8

Motors = tuple[Motor, ...]
Drives = tuple[Drive, ...]
Transmissions = tuple[Transmission, ...]


class Script(NamedTuple):
    """What the loop is given besides the robot."""

    position: Array  # (n, 5) set-points
    velocity: Array  # (n, 5)
    contact: Array  # (n, 3) force at the tip in {b}
    delay: Array  # (n, 5) from the command's tick to its arrival at the drive [s]; inf: it never arrives
    glitch: Array  # (n, 5) what the load encoder adds
    side: Array  # (5,) +-1, side of a gap on which the run starts
    period: float


@compiled_inner
def rounded(x: float, resolution: float) -> float:
    """Return `x` rounded to the nearest multiple of `resolution`; 0 means exact."""
    return x if resolution == 0.0 else round(x / resolution) * resolution


@compiled_inner
def load_of(t: Transmission, state: Array, load: float, slip: Array, follower: Array) -> float:
    """Advance lost motion of an axis, stacks (4,), to its present input, of a state (7,); return the load position."""
    x = state[LOAD_Q] if t.compliance > 0.0 else input_position(t, state[Q])
    if t.bump != 0.0:
        place = (state[Q] - t.bump_place) / t.bump_width
        x -= load * t.bump * math.exp(-place * place)
    out = x
    if t.hysteresis != 0.0:
        out -= t.hysteresis * bent(t, state[Q]) * slip_state(x, slip, t.hysteresis_reach)
        drag_anchors(x, slip, t.hysteresis_reach)
    if t.backlash != 0.0:
        out += play_offset(x, t.backlash * bent(t, state[Q]), follower)
    return out


@compiled_inner
def encoder_angle(h: Host, j: int, load: float, speed: float) -> float:
    """Return what the load encoder would read without quantisation, hysteresis and jumps."""
    x = load - h.encoder_lag[j] * speed
    turn = 2 * math.pi * load / h.lead[j] + h.eccentricity_phase[j]
    off = h.encoder_scale[j] * x + h.eccentricity[j] * math.sin(turn)
    return x + off * (1.0 + h.bend[j] * math.sin(h.bend_rate[j] * load + h.bend_phase[j]))


@compiled_inner
def start_states(
    m: Motors, d: Drives, t: Transmissions, h: Host, g: Geometry, s: Script, pose: Array, slip: Array, follower: Array
) -> Array:
    """Return (5, 7) states at rest with the load encoders at the first set-point and the drives holding."""
    state = np.zeros((AXES, STATES))
    target = s.position[0] - h.offset
    q = target.copy()
    for j in range(AXES):
        for _ in range(6):
            q[j] -= encoder_angle(h, j, q[j], 0.0) - target[j]
    gravity, external = load_forces(g, q, pose, s.contact[0])
    for j in range(AXES):
        load = gravity[j] * weight_gain(m[j], q[j]) - external[j]
        lost = 0.5 * s.side[j] * t[j].backlash + s.side[j] * t[j].hysteresis
        sprung = load * t[j].compliance * (1 + t[j].compliance_slope * q[j]) * bent(t[j], q[j])
        motor = q[j]
        for _ in range(6):
            motor -= input_position(t[j], motor) - q[j] - lost - sprung
        state[j, Q] = motor
        state[j, LOAD_Q] = q[j] + lost
        reach = t[j].hysteresis_reach
        for i in range(ELEMENTS):
            follower[j, i] = q[j]
            slip[2, j, i] = q[j] + lost - s.side[j] * 3 * reach
            slip[0, j, i] = slip[1, j, i] = motor
        drag_anchors(q[j] + lost, slip[2, j], reach)
        held = load - motor_force(m[j], motor, 0.0, 0.0, 0.0, slip[0, j], slip[1, j])
        force = held / (1.0 + (m[j].torque_gain - 1.0) * motor_bent(m[j], motor, 0.0))
        state[j, XI] = force / d[j].ki
        state[j, 4] = force
    return state


@compiled_inner
def host_command(h: Host, j: int, s: Script, k: int, readings: Array) -> float:
    """Return the host's velocity command of axis `j` at tick `k`, by the readings (n, 5)."""
    seen = readings[max(0, k - 1), j] if h.stale[j] > 0.0 else readings[k, j]
    u = s.velocity[k, j] + h.gain[j] * (s.position[k, j] - seen)
    u = min(h.velocity_limit[j], max(-h.velocity_limit[j], u))
    return rounded(u, h.command_resolution[j])


@compiled_inner
def taken(h: Host, j: int, demand: float, held: float, period: float) -> float:
    """Return the demand the drive takes from a command, given the one it holds."""
    demand = rounded(demand, h.demand_resolution[j])
    if h.demand_slew[j] > 0.0:
        step = h.demand_slew[j] * period
        demand = min(held + step, max(held - step, demand))
    return demand


@compiled_inner
def tick_interval(
    m: Motor, d: Drive, t: Transmission, h: Host, j: int, k: int, s: Script, state: Array, held: float,
    load: Array, command: Array, slip: Array,
) -> tuple[float, float]:  # fmt: skip
    """Integrate axis `j` over the interval after tick `k`; return the demand held at its end and the mean demand.

    `state` (7,) and `slip` (4, 5, 4) are moved on; `command` is (n, 5).
    """
    at, total, begin, whole = 0.0, 0.0, k * s.period, False
    for c in range(max(0, k - HISTORY), k + 2):
        end = c > k
        arrival = s.period if end else (c - k) * s.period + s.delay[c, j]
        if not at <= arrival < s.period and not end:
            continue
        if arrival > at:
            advance(m, d, t, state, held, load, begin + at, arrival - at, slip[0, j], slip[1, j])
            total += held * (arrival - at)
            whole = at == 0.0 and end
            at = arrival
        if not end:
            held = taken(h, j, command[c, j], held, s.period)
    if whole:
        return held, held
    return held, total / s.period


@compiled
def _run(m: Motors, d: Drives, t: Transmissions, h: Host, g: Geometry, odd: Foreign, s: Script) -> Course:
    """Run the closed loop over the script."""
    n, memory, extra = len(s.position), np.zeros(1), 0.0
    out = Course(
        np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)),
        np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)),
    )  # fmt: skip
    slip, follower = np.zeros((4, AXES, ELEMENTS)), np.zeros((AXES, ELEMENTS))
    pose = np.zeros(6)
    pose[2] = 0.05 + s.position[0, :3].mean()
    state = start_states(m, d, t, h, g, s, pose, slip, follower)
    slip[3] = follower
    held, load, load_before = np.zeros(AXES), np.zeros((AXES, 2)), np.zeros(AXES)
    for k in range(n):
        for j in range(AXES):
            q = load_of(t[j], state[j], load[j, 0], slip[2, j], follower[j])
            speed = state[j, LOAD_V] if t[j].compliance > 0.0 else state[j, V]
            reading = encoder_angle(h, j, q, speed) + h.offset[j] + s.glitch[k, j]
            if odd.where == ON_READING and odd.on == j:
                reading += extra
            if h.encoder_loop[j] > 0.0:
                reading += play_offset(reading, 2 * h.encoder_loop[j], slip[3, j])
            out.load[k, j], out.motor[k, j] = q, state[j, Q]
            out.load_reading[k, j] = rounded(reading, h.load_resolution[j])
            out.motor_reading[k, j] = rounded(state[j, Q] + h.offset[j], h.motor_resolution[j])
            out.force[k, j] = reported_force(d[j], state[j], held[j], k * s.period)
            out.command[k, j] = host_command(h, j, s, k, out.load_reading)
        total = (np.abs(out.force[k]) / h.force_limit).sum() * h.sag[0]
        gravity, external = load_forces(g, out.load[k], pose, s.contact[k])
        speed_now = np.ascontiguousarray(state[:, V])
        coupling = h.coupling @ speed_now
        extra = foreign(odd, out.load[k], speed_now, out.force[k], memory, s.period)
        if odd.where == ON_FORCE:
            coupling[odd.on] += extra
        for j in range(AXES):
            now = gravity[j] * weight_gain(m[j], out.load[k, j]) - external[j] + coupling[j] + total * out.force[k, j]
            slope = (now - load_before[j]) / s.period if k > 0 else 0.0
            load_before[j] = now
            load[j, 0], load[j, 1] = now - slope * k * s.period, slope
            held[j], mean = tick_interval(m[j], d[j], t[j], h, j, k, s, state[j], held[j], load[j], out.command, slip)
            load[j, 0] = now
            if k + 1 < n:
                out.echo[k + 1, j] = mean
    return out


def run_loop(p: TruthParameters, odd: Foreign, s: Script) -> Course:
    """Run the closed loop of one robot over a script."""
    motors, drives, transmissions = (
        tuple(axis_slice(part, j) for j in range(AXES)) for part in (p.motor, p.drive, p.transmission)
    )
    return _run(motors, drives, transmissions, p.host, p.geometry, odd, s)
