"""The closed loop of one run in one compiled call: host, transport, all axes abreast, encoders."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sher3_challenge.plants.arrays import Course, axis_slice
from sher3_challenge.plants.compiled import compiled, compiled_inner
from sher3_challenge.plants.grammar import ON_FORCE, ON_READING, Foreign, foreign
from sher3_challenge.plants.plant import AXES, Array
from sher3_challenge.plants.tables.axis import (
    FORCE,
    LOOP,
    MOUNT_Q,
    POLE,
    SNAP,
    STATES,
    X1,
    X2,
    XI,
    Q,
    V,
    advance,
    bent,
    driven,
    load_position,
    motor_resistance,
    reported_force,
)
from sher3_challenge.plants.tables.curves import around, at
from sher3_challenge.plants.tables.mechanism import ROOM, load_forces
from sher3_challenge.plants.tables.parameters import (
    Drive,
    Host,
    Mechanism,
    Motor,
    Odd,
    TableParameters,
    Transmission,
)

STEP = 2e-4
"""Step of integration [s], a twentieth of the drives' time constant."""
ABREAST = 5
"""Steps after which the axes learn of each other: 1 ms, in which a weight changes by a millinewton."""

Motors = tuple[Motor, ...]
Drives = tuple[Drive, ...]
Odds = tuple[Odd, ...]
Transmissions = tuple[Transmission, ...]
Hosts = tuple[Host, ...]


class Script(NamedTuple):
    """What the loop is given besides the robot."""

    position: Array  # (n, 5) set-points
    velocity: Array
    contact: Array  # (n, 3) force at the tip in {b}
    arrival: Array  # (n, 5) seconds from the start at which a command reaches its drive; inf: never
    side: Array  # (5,) +-1, side of a gap on which the run starts
    period: float


@compiled_inner
def counted(x: float, count: float) -> float:
    """Return `x` rounded to counts; 0 means exact."""
    return x if count == 0.0 else round(x / count) * count


@compiled_inner
def seen(m: Motor, o: Odd, h: Host, x: float, speed: float) -> float:
    """Return what the load encoder sees of a position before it counts."""
    out = x + bent(m, x, 0.0) * (h.scale * x + around(h.eccentricity, x / m.lead))
    if o.grating != 0.0:
        phase = 2 * math.pi * x / o.grating_period
        out += o.grating * (math.sin(phase) + 2.0 * min(1.0, abs(speed) / m.top) * math.sin(2 * phase + 0.6))
    return out


@compiled_inner
def weighed(m: Motors, g: Mechanism, load: Array, force: Array, gravity: Array, external: Array, room: Array) -> None:
    """Write the load force of every axis into `gravity` (5,): its weight by its own table, less the contact (3,)."""
    load_forces(g, load, force, gravity, external, room)
    for j in range(AXES):
        beyond = at(m[j].gravity_gain, 0.5 + 0.25 * load[j] / m[j].span) - 1.0
        gravity[j] = gravity[j] * (1.0 + beyond * bent(m[j], load[j], 0.0)) - external[j]


@compiled_inner
def start(m: Motor, d: Drive, o: Odd, t: Transmission, y: Array, x: float, load: float, side: float) -> None:
    """Put an axis (20,) at rest: its load at `x` under a force, its lost motion on a side, its drive holding."""
    y[LOOP] = side
    y[SNAP] = -1.0 if x > o.place else 1.0
    y[X2] = x + side * t.hysteresis
    y[X1] = y[X2] + 0.4 * side * t.gap
    wound = 0.0
    for _ in range(40):
        if t.compliance > 0.0:
            wound = load * t.compliance * bent(m, x, 0.0) / at(t.stiffening, abs(wound / t.compliance) / m.full)
    motor = y[X1] + wound
    for _ in range(6):
        motor -= driven(t, m, motor) - y[X1] - wound
    y[Q] = y[MOUNT_Q] = motor
    if m.mount_mass > 0.0:
        y[MOUNT_Q] -= m.mount_weight / m.mount_stiffness
    holds = load + m.mount_weight + motor_resistance(m, o, y, 0.0)
    force = holds
    for _ in range(8):
        force = holds / (1.0 + (at(m.force_gain, abs(force) / m.full) - 1.0) * bent(m, motor, 0.0))
    y[POLE] = y[FORCE] = force
    swallowed = o.crossover
    if swallowed > 0.0:
        force = force + math.copysign(swallowed, force) if abs(force) < 5 * swallowed else force * 6 / 5
    y[XI] = force / d.ki


@compiled_inner
def begin(
    m: Motors, d: Drives, o: Odds, t: Transmissions, h: Hosts, g: Mechanism, s: Script, force: Array, room: Array
) -> Array:
    """Return (5, STATES) at rest with the load encoders at the first set-point; fill the load forces `force`."""
    y, x = np.zeros((AXES, STATES)), np.empty(AXES)
    for j in range(AXES):
        wanted = s.position[0, j] - h[j].offset + h[j].start
        x[j] = wanted
        for _ in range(6):
            x[j] -= seen(m[j], o[j], h[j], x[j], 0.0) - wanted
    weighed(m, g, x, s.contact[0], force, np.zeros(AXES), room)
    for j in range(AXES):
        start(m[j], d[j], o[j], t[j], y[j], x[j], force[j], s.side[j])
    return y


@compiled_inner
def held_mean(average: float, j: int, s: Script, command: Array, begin: float, end: float, drive: Array) -> float:
    """Return the mean demand of axis `j` over a step; what it holds and the next command, `drive` (2, 5), move on."""
    total, now = 0.0, begin
    while drive[1, j] < len(command):
        c = int(drive[1, j])
        arrival = s.arrival[c, j]
        if arrival >= end - 1e-12:
            if arrival == np.inf and c * s.period <= begin:
                drive[1, j] += 1
                continue
            break
        moment = max(now, arrival)
        total += drive[0, j] * (moment - now)
        now = moment
        before = command[c - 1, j] if c > 0 else 0.0
        drive[0, j] = (1.0 - average) * command[c, j] + average * before
        drive[1, j] += 1
    return drive[0, j] if now == begin else (total + drive[0, j] * (end - now)) / (end - begin)


@compiled_inner
def read_encoders(m: Motor, o: Odd, h: Host, j: int, k: int, y: Array, x: float, off: float, out: Course) -> None:
    """Write positions and readings of axis `j`, a state (20,), at tick `k`; the load encoder reads `off` too much."""
    out.motor[k, j], out.load[k, j] = y[Q], x
    out.load_reading[k, j] = counted(seen(m, o, h, x, y[V]) + off + h.offset + h.load_edge, h.load_count)
    if o.repeat > 0.0 and k > 0 and k % int(o.repeat) == 0:
        out.load_reading[k, j] = out.load_reading[k - 1, j]
    out.motor_reading[k, j] = counted(y[Q] + h.offset + h.motor_edge, h.motor_count)


@compiled_inner
def commanded(o: Odd, h: Host, j: int, s: Script, k: int, reading: float, worked: Array) -> float:
    """Return the host's velocity command; `worked` (5,) keeps the reading that it works with."""
    worked[j] = reading if k == 0 else (1.0 - o.smoothing) * reading + o.smoothing * worked[j]
    u = s.velocity[k, j] + h.gain * (s.position[k, j] - worked[j])
    return min(h.velocity_limit, max(-h.velocity_limit, u))


@compiled
def _run(
    m: Motors, o: Odds, d: Drives, t: Transmissions, h: Hosts, g: Mechanism, stray: Array, odd: Foreign, s: Script
) -> Course:
    """Run the closed loop over the script; `stray` (5, 5) is the force on one axis per force of another drive."""
    n = len(s.position)
    out = Course(
        np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)),
        np.zeros((n, AXES)), np.zeros((n, AXES)), np.zeros((n, AXES)),
    )  # fmt: skip
    force, load, external, contact = np.zeros(AXES), np.zeros(AXES), np.zeros(AXES), np.zeros(3)
    memory, extra = np.zeros(1), np.zeros(AXES)
    drive, worked, demands, room = np.zeros((2, AXES)), np.zeros(AXES), np.zeros(ABREAST), np.zeros((ROOM, 3))
    y = begin(m, d, o, t, h, g, s, force, room)
    rounds = round(s.period / STEP / ABREAST)
    step = s.period / (rounds * ABREAST)
    for k in range(n):
        for j in range(AXES):
            read_encoders(m[j], o[j], h[j], j, k, y[j], load_position(m[j], o[j], t[j], y[j]), extra[j], out)
            out.command[k, j] = commanded(o[j], h[j], j, s, k, out.load_reading[k, j], worked)
            out.force[k, j] = reported_force(d[j], o[j], m[j], y[j], drive[0, j])
        if k + 1 == n:
            break
        strayed = stray @ out.force[k]
        more = foreign(odd, out.load[k], np.ascontiguousarray(y[:, V]), out.force[k], memory, s.period)
        if odd.where == ON_FORCE:
            strayed[odd.on] += more
        if odd.where == ON_READING:
            extra[odd.on] = more
        for i in range(rounds):
            time, share = k * s.period + i * ABREAST * step, (i + 0.5) / rounds
            for a in range(3):
                contact[a] = s.contact[k, a] + share * (s.contact[k + 1, a] - s.contact[k, a])
            for j in range(AXES):
                load[j] = load_position(m[j], o[j], t[j], y[j])
            weighed(m, g, load, contact, force, external, room)
            for j in range(AXES):
                for b in range(ABREAST):
                    now = time + b * step
                    demands[b] = held_mean(o[j].average, j, s, out.command, now, now + step, drive)
                    seen_so_far = i * ABREAST + b
                    out.echo[k + 1, j] += (demands[b] - out.echo[k + 1, j]) / (seen_so_far + 1)
                advance(m[j], d[j], o[j], t[j], y[j], demands, force[j] + strayed[j], time, step)
    return out


def run_loop(p: TableParameters, odd: Foreign, s: Script) -> Course:
    """Run the closed loop of one robot over a script."""
    parts = (p.motor, p.odd, p.drive, p.transmission, p.host)
    motor, odds, drive, transmission, host = (tuple(axis_slice(part, j) for j in range(AXES)) for part in parts)
    return _run(motor, odds, drive, transmission, host, p.mechanism, p.stray, odd, s)
