"""The compiled plant: one control period of the whole robot, and whole runs of it under the host's law."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.laws import MEMORY, MOST_FACTORS
from sher3_description.contract import GRAVITY, REFERENCE_TEMPERATURE
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import KernelParameters, gravity_load_into, tip_jacobian_into

from sher3_sim.found import BODY_QUANTITIES, BODY_TERMS, SENSOR, add_body
from sher3_sim.kernel.axis import advance, drive_force, send
from sher3_sim.kernel.noise import DISTURBANCE, DROP, EFFORT, FORCE, JITTER, TRACKER, normal, uniform
from sher3_sim.kernel.quantities import asked, begin_at_rest, look_at_axes, sent
from sher3_sim.kernel.tip import cross, quaternion, true_tip
from sher3_sim.kernel.transmission import encode_load, felt, place, to_count, transmit

Array = np.ndarray

BODY_STATE = np.dtype(
    [
        ("tick", "i8"),
        ("seed", "i8"),
        ("wrench", "f8", 6),
        ("load", "f8", 5),
        ("jacobian", "f8", (6, 5)),
        ("tip_rate", "f8", 3),
        ("mode_shift", "f8", 3),
        ("mode_rate", "f8", 3),
        ("cable", "f8", 3),
        ("cable_start", "f8", 3),
        ("cable_last", "f8", 3),
        ("found_inputs", "f8", len(BODY_QUANTITIES)),
        ("found_last", "f8", (BODY_TERMS, MOST_FACTORS)),
        ("found_memory", "f8", (BODY_TERMS, MOST_FACTORS, MEMORY)),
    ]
)

READING = np.dtype(
    [
        ("motor", "f8", 5),
        ("velocity", "f8", 5),
        ("effort", "f8", 5),
        ("load", "f8", 5),
        ("demand", "f8", 5),
        ("wrench", "f8", 6),
        ("tip_position", "f8", 3),
        ("tip_rotation", "f8", (3, 3)),
        ("tracked", "?"),
        ("tracker_position", "f8", 3),
        ("tracker_orientation", "f8", 4),
    ]
)


@compiled
def _loads(p: KernelParameters, axis: Any, state: Any, s: Any, wrench: Array, ahead: float) -> None:
    """Write into `s` the load G - tau_ext of every axis `ahead` seconds from now, and the tip Jacobian there."""
    q = np.empty(5)
    gravity = np.empty(5)
    for i in range(5):
        q[i] = state[i].load + ahead * state[i].velocity
    gravity_load_into(p, q, gravity)
    tip_jacobian_into(p, q, s.jacobian)
    for i in range(5):
        contact = 0.0
        for j in range(6):
            contact += s.jacobian[j, i] * wrench[j]
        s.load[i] = gravity[i] * (1.0 + axis[i].gravity_scale) - contact


@compiled
def read_sensors(axis: Any, b: Any, p: KernelParameters, state: Any, s: Any, r: Any) -> None:
    """Sample every sensor at the present tick into the READING record."""
    q = np.empty(5)
    tip_rate = np.zeros(3)
    tick = s.tick
    for i in range(5):
        a, x = axis[i], state[i]
        q[i] = x.load
        motor = to_count(x.position + a.encoder_offset, a.motor_count)
        r.velocity[i] = (motor - r.motor[i]) / b.period if tick > 0 else 0.0
        r.motor[i] = motor
        r.load[i] = to_count(encode_load(a, x.load) + a.load_zero, a.load_count)
        noise = a.effort_noise * normal(s.seed, EFFORT + i, tick)
        r.effort[i] = to_count(drive_force(a, x) + noise, a.effort_count)
        r.demand[i] = x.echo
        for j in range(3):
            tip_rate[j] += s.jacobian[j, i] * x.velocity
    true_tip(p, axis, b, s, state, q, s.load, s.wrench, tip_rate, s.jacobian, r.tip_rotation, r.tip_position)
    _read_wrench(b, s, r)
    _read_tracker(b, s, r)


@compiled
def _read_wrench(b: Any, s: Any, r: Any) -> None:
    """Read the force sensor.

    Contact and tool weight are moved to {f}; then come cable, sensor matrix, bias, drift, noise, rounding and range.
    """
    force, moment = np.zeros(3), np.zeros(3)
    weight, cable = np.empty(3), np.zeros(3)
    rotation = r.tip_rotation
    if b.sensor_cable_displacement > 0.0:
        for i in range(3):
            if s.tick == 0:
                s.cable_start[i] = s.cable_last[i] = r.tip_position[i]
            moved = r.tip_position[i] - s.cable_last[i]
            s.cable_last[i] = r.tip_position[i]
            end = math.copysign(1.0, moved)
            s.cable[i] = end + (s.cable[i] - end) * math.exp(-abs(moved) / b.sensor_cable_displacement)
            pull = b.sensor_cable_stiffness * (r.tip_position[i] - s.cable_start[i])
            cable[i] = -pull - b.sensor_cable_force * s.cable[i]
    for i in range(3):
        weight[i] = -rotation[2, i] * b.tool_mass * GRAVITY
        for j in range(3):
            force[i] += rotation[j, i] * (s.wrench[j] + cable[j])
            moment[i] += rotation[j, i] * s.wrench[3 + j]
    moment += cross(b.tool_com, weight) - cross(b.sensor_position, force)
    force += weight
    more = np.zeros(6)
    if b.found_any:
        add_body(b.found, SENSOR, s, b.period, more)
    for i in range(6):
        value = more[i] + b.wrench_bias[i] + b.wrench_drift[i] * (b.temperature - REFERENCE_TEMPERATURE)
        for j in range(3):
            value += b.wrench_matrix[i, j] * force[j] + b.wrench_matrix[i, 3 + j] * moment[j]
        value += b.wrench_noise[i] * normal(s.seed, FORCE + i, s.tick)
        r.wrench[i] = to_count(min(max(value, -b.wrench_range[i]), b.wrench_range[i]), b.wrench_resolution[i])


@compiled
def _read_tracker(b: Any, s: Any, r: Any) -> None:
    """Tracker: the true tip pose with noise, at its own rate."""
    samples = b.period / b.tracker_period
    r.tracked = s.tick == 0 or math.floor(s.tick * samples + 1e-9) > math.floor((s.tick - 1) * samples + 1e-9)
    if not r.tracked:
        return
    o = r.tracker_orientation
    quaternion(r.tip_rotation, o)
    half = np.empty(3)
    for i in range(3):
        r.tracker_position[i] = r.tip_position[i] + b.tracker_noise[0] * normal(s.seed, TRACKER + i, s.tick)
        half[i] = 0.5 * b.tracker_noise[1] * normal(s.seed, TRACKER + 3 + i, s.tick)
    x, y, z, w = o[0], o[1], o[2], o[3]
    o[0] = x + half[0] * w + half[1] * z - half[2] * y
    o[1] = y + half[1] * w + half[2] * x - half[0] * z
    o[2] = z + half[2] * w + half[0] * y - half[1] * x
    o[3] = w - half[0] * x - half[1] * y - half[2] * z
    norm = math.sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2] + o[3] * o[3])
    for i in range(4):
        o[i] /= norm


@compiled
def start(axis: Any, b: Any, p: KernelParameters, state: Any, s: Any, r: Any, q_ref: Array, wrench: Array) -> None:
    """Put the plant at rest at q_ref, held by its drives under a contact wrench, and sample the first tick."""
    for i in range(6):
        s.wrench[i] = wrench[i]
    for i in range(5):
        state[i].load = q_ref[i]
    for _ in range(2):
        _loads(p, axis, state, s, wrench, 0.0)
        for i in range(5):
            state[i].effort_load = s.load[i]
            place(axis[i], state[i], q_ref[i] + axis[i].start_offset)
    for i in range(5):
        a, x = axis[i], state[i]
        other = s.load[i]
        if a.cogging_amplitude != 0.0:
            angle = 2.0 * math.pi * a.cogging_periods * x.position / a.lead + a.cogging_phase
            other += a.cogging_amplitude * math.sin(angle)
        other += a.cable_stiffness * x.position
        x.integral = min(max(other / a.torque_scale, -a.limit), a.limit)
        x.force = x.integral
    look_at_axes(axis, b, state, s)
    read_sensors(axis, b, p, state, s, r)
    for i in range(5):
        begin_at_rest(state[i], r.load[i])


@compiled
def step(
    axis: Any,
    b: Any,
    p: KernelParameters,
    maps: Array,
    substeps: int,
    state: Any,
    s: Any,
    r: Any,
    command: Array,
    wrench: Array,
) -> None:
    """Advance the plant by one control period.

    Args:
        axis: AXIS records.
        b: BODY record.
        p: Geometry of the true mechanism.
        maps: Propagators for `period / substeps`, (5, 2, 2, 4, 5).
        substeps: Steps in the period.
        state: AXIS_STATE records, changed in place.
        s: BODY_STATE record, changed in place.
        r: READING record: receives the sensors at the end of the period.
        command: Velocities sent at the beginning of the period (5,) [m/s, rad/s].
        wrench: Contact wrench on the tip in {b} at the end of the period (6,). Over the period the mean of the wrenches
            at its two ends acts.
    """
    mean = np.empty(6)
    for i in range(6):
        mean[i] = 0.5 * (s.wrench[i] + wrench[i])
        s.wrench[i] = wrench[i]
    _loads(p, axis, state, s, mean, 0.5 * b.period)
    look_at_axes(axis, b, state, s)
    for i in range(5):
        a, x = axis[i], state[i]
        late = a.jitter * abs(normal(s.seed, JITTER, s.tick)) if a.jitter > 0.0 else 0.0
        if a.drop == 0.0 or uniform(s.seed, DROP, s.tick) >= a.drop:
            send(x, sent(a, x, command[i], b.period), a.delay + late)
        if a.disturbance > 0.0:
            kept = math.exp(-b.period / a.disturbance_time)
            fresh = math.sqrt(1.0 - kept * kept) * a.disturbance * normal(s.seed, DISTURBANCE + i, s.tick)
            x.disturbance = kept * x.disturbance + fresh
        advance(a, x, maps[i], felt(a, x, s.load[i], b.period) + x.disturbance, s.tick * b.period, b.period, substeps)
        transmit(a, x, s.load[i], b.period)
    s.tick += 1
    read_sensors(axis, b, p, state, s, r)


READING_SIZE = 5 * 5 + 6 + 1 + 3 + 4
"""Numbers of a reading as `step_flat` writes them: five columns of five, wrench, tracked, tracker pose."""


@compiled
def flatten(r: Any, flat: Array) -> None:
    """Write a READING record as numbers (READING_SIZE,)."""
    for i in range(5):
        flat[i], flat[5 + i], flat[10 + i] = r.motor[i], r.velocity[i], r.effort[i]
        flat[15 + i], flat[20 + i] = r.load[i], r.demand[i]
    for i in range(6):
        flat[25 + i] = r.wrench[i]
    flat[31] = 1.0 if r.tracked else 0.0
    for i in range(3):
        flat[32 + i] = r.tracker_position[i]
    for i in range(4):
        flat[35 + i] = r.tracker_orientation[i]


@compiled
def step_flat(
    axis: Any,
    body: Any,
    geometry: Array,
    maps: Array,
    substeps: int,
    state: Any,
    s: Any,
    r: Any,
    command: Array,
    wrench: Array,
    temperature: float,
    flat: Array,
) -> None:
    """Do as `step` does and write the reading into `flat` (READING_SIZE,), for a caller in Python.

    Records are slow arguments for such a caller. So `body`, `s` and `r` are arrays of one record each, `geometry` is an
    array (44,), and `temperature` [degC], that of the structure, is an argument of its own.
    """
    body[0].temperature = temperature
    step(axis, body[0], unpack(geometry), maps, substeps, state, s[0], r[0], command, wrench)
    flatten(r[0], flat)


@compiled
def host_command(
    axis: Any, state: Any, setpoint: Array, setpoint_rate: Array, load_reading: Array, period: float, out: Array
) -> None:
    """Write the velocities the host commands in position modes, clamped: contract, section 3."""
    for i in range(5):
        a, top = axis[i], axis[i].velocity_limit
        wanted = setpoint_rate[i] + a.position_gain * (setpoint[i] - load_reading[i])
        wanted = min(max(wanted, -top), top)
        out[i] = min(max(asked(a, state[i], wanted, setpoint[i], load_reading[i], period), -top), top)


@compiled
def run(
    axis: Any,
    b: Any,
    p: KernelParameters,
    maps: Array,
    substeps: int,
    state: Any,
    s: Any,
    closed: bool,
    setpoint: Array,
    rate: Array,
    command: Array,
    wrench: Array,
    temperature: Array,
    out: Any,
) -> None:
    """Run n ticks, in closed loop on set-points or in open loop on recorded commands.

    Args:
        axis: AXIS records.
        b: BODY record; its temperature is changed.
        p: Geometry of the true mechanism.
        maps: Propagators.
        substeps: Steps in the period.
        state: AXIS_STATE records, fresh.
        s: BODY_STATE record, fresh but for the seed.
        closed: True for the host's law on the set-points, false for `command` as it is.
        setpoint: q_ref (n, 5); the first row is the start in either mode.
        rate: Rate of q_ref (n, 5).
        command: Commanded velocities (n, 5): written in closed loop, read in open loop.
        wrench: Contact wrench at the ticks (n, 6).
        temperature: Temperature of the structure at the ticks (n,) [degC].
        out: READING records (n,), written.
    """
    b.temperature = temperature[0]
    start(axis, b, p, state, s, out[0], setpoint[0], wrench[0])
    for k in range(len(out)):
        if closed:
            host_command(axis, state, setpoint[k], rate[k], out[k].load, b.period, command[k])
        if k + 1 < len(out):
            for i in range(5):
                out[k + 1].motor[i] = out[k].motor[i]
            b.temperature = temperature[k + 1]
            step(axis, b, p, maps, substeps, state, s, out[k + 1], command[k], wrench[k + 1])
