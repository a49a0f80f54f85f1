"""The closed loop of one run: host and transport per tick, MuJoCo between the ticks."""

from __future__ import annotations

from collections import OrderedDict
from copy import deepcopy
from typing import NamedTuple

import joblib
import numpy as np

from sher3_challenge.plants.grammar import ON_FORCE, ON_READING, foreign
from sher3_challenge.plants.mujoco.axes.field import Field
from sher3_challenge.plants.mujoco.axes.mjcf import SUBSTEPS
from sher3_challenge.plants.mujoco.axes.model import machine
from sher3_challenge.plants.mujoco.axes.parts import AXES, RUBBER_SOFT, Array, Axis, Host
from sher3_challenge.plants.mujoco.axes.servo import Servos
from sher3_challenge.plants.mujoco.axes.transport import Transport
from sher3_challenge.plants.mujoco.axes.wheels import Eccentrics
from sher3_challenge.plants.mujoco.engine import mujoco

REMEMBERED = 24
"""Runs kept: those of a fault behind the axes are the same at every magnitude."""


class Script(NamedTuple):
    """What a run is given besides the robot."""

    position: Array  # (n, 5) set-points
    velocity: Array  # (n, 5)
    field: Field
    arrival: Array  # (n, 5) time from a command's tick to its arrival [s]; inf: it is lost
    side: Array  # (5,) +-1, side of a play on which the run starts
    period: float


class Course(NamedTuple):
    """What the loop leaves behind, all (n, 5) per tick."""

    command: Array
    echo: Array
    load: Array  # true load position
    leg: Array  # position at the mechanism, behind any play there
    force: Array  # force the drive reports, before noise
    motor_reading: Array
    load_reading: Array


def run_loop(axes: list[Axis], host: Host, script: Script) -> Course:
    """Run the closed loop; the same axes, host and script give the same answer without running again."""
    task = str(joblib.hash((axes, host, script)))
    if task not in _courses:
        _courses[task] = Loop(*deepcopy((axes, host, script))).run()
    _courses.move_to_end(task)
    while len(_courses) > REMEMBERED:
        _courses.popitem(last=False)
    return _courses[task]


_courses: OrderedDict[str, Course] = OrderedDict()


class Loop:
    """One run: the machine, its host, and what is recorded."""

    def __init__(self, axes: list[Axis], host: Host, script: Script) -> None:
        self.axes, self.host, self.script = axes, host, script
        self.n, self.period = len(script.position), script.period
        self.machine = machine(axes, script.period)
        self.model, self.data = self.machine.model, self.machine.data
        self.ripples = Eccentrics([(j, wheel) for j, axis in enumerate(axes) for wheel in axis.ripples], AXES)
        self.gain = np.array([axis.gravity_gain for axis in axes])
        self.constant = np.array([axis.constant for axis in axes])
        self._start()

    def positions(self, shares: Array, q: Array) -> Array:
        """Return (..., 5) positions behind the motors: shares of the joints' (..., nq), and ripples."""
        motor = q[..., self.machine.motor]
        return np.asarray(motor + (q @ shares.T + self.ripples(motor) - motor) * self.host.bend.factor(motor))

    def load_angle(self, load: Array, q: Array) -> Array:
        """Return (5,) what the load encoders would read without rounding."""
        off = self.host.encoder_scale * load + self.machine.read @ q
        for j, disc in self.host.discs.items():
            off[j] += disc(load[j])
        return np.asarray(load + off * self.host.bend.factor(load))

    def _loads(self, k: int, load: Array) -> Array:
        """Return (5,) the force on the axes at tick `k`: contact, less weight and constant forces."""
        field = self.script.field
        weight = field.gravity[k] + field.slope[k] @ (load - self.script.position[k])
        gain = 1 + (self.gain - 1) * self.host.bend.factor(load)
        return np.asarray(field.contact[k] - gain * weight - self.constant)

    def _start(self) -> None:
        """Stand at rest with the load encoders at the first set-point, plays at one side, and the drives holding."""
        m, d, target = self.machine, self.data, self.script.position[0] + self.host.start - self.host.offset
        q = np.zeros(self.model.nq)
        x, load = target.copy(), target.copy()
        for _ in range(6):  # the encoders' own errors are small against what they read
            self._place(q, x)
            load = self.positions(m.load, q)
            x += target - self.load_angle(load, q)
        d.qpos[:] = q
        mujoco.mj_forward(self.model, d)
        d.qfrc_applied[m.load_force] = self._loads(0, load)
        d.qacc[:] = 0.0
        mujoco.mj_inverse(self.model, d)
        held = d.qfrc_inverse[m.motor] - d.qfrc_applied[m.motor]
        for j, axis in enumerate(self.axes):
            held[j] -= sum(push(float(q[m.motor[j]]), 0.0, 0.0) for push in axis.pushes)
        self.servos = Servos(self.axes, m, held, self.period / SUBSTEPS)
        self.transport = Transport(self.script.arrival, self.period, self.axes, self.host.hold)

    def _place(self, q: Array, x: Array) -> None:
        """Put the bodies of every axis where its load is at `x`, springs that carry it stretched, plays at a side."""
        m, pull = self.machine, -self._loads(0, self.script.position[0])
        for j, axis in enumerate(self.axes):
            q[m.follows[j]] = x[j]
            stretch = pull[j] * (axis.compliance + axis.rubber) + 0.5 * self.script.side[j] * axis.gap
            q[m.motor[j]] = x[j] / (1 + axis.lead_error) + stretch
            if axis.rubber > 0.0:
                q[m.middle[j]] = x[j] + RUBBER_SOFT * pull[j] * axis.rubber

    def run(self) -> Course:
        """Run over the script."""
        m, d, host, s, n = self.machine, self.data, self.host, self.script, self.n
        joints, speed = np.empty((n, self.model.nq)), np.empty((n, self.model.nv))
        state, held = np.empty((n, self.model.na)), np.empty((n, AXES))
        command, echo, reading = np.zeros((n, AXES)), np.zeros((n, AXES)), np.empty((n, AXES))
        keep = np.exp(-self.period / np.maximum(host.smoothing, 1e-9))
        odd, memory, extra = host.foreign, np.zeros(1), np.zeros((5, AXES))
        half, sent = 0.5 * self.period / SUBSTEPS, np.zeros(AXES)
        for k in range(n):
            speed[k], state[k], held[k] = d.qvel, d.act, self.servos.demand
            q = joints[k] = d.qpos - half * speed[k]
            load = self.positions(m.load, q)
            seen = self.load_angle(load, q) + extra[ON_READING] + host.offset
            reading[k] = rounded(seen, host.load_resolution, host.edge)
            self.servos.tell()
            law = s.velocity[k] + host.gain * (s.position[k] - reading[k])
            law = np.minimum(host.velocity_limit, np.maximum(-host.velocity_limit, law))
            command[k] = sent = law + keep * (sent - law)
            force = self.servos.now(q[m.motor], speed[k][m.motor])
            extra[odd.where, odd.on] = foreign(odd, load, speed[k][m.motor], force, memory, self.period)
            d.qfrc_applied[m.load_force] = self._loads(k, load) - extra[ON_FORCE]
            mean = self.transport.take(k, command)
            if k + 1 < n:
                echo[k + 1] = mean
            self.servos.advance(self.transport.demand, self.transport.steady, k * self.period)
        motor = rounded(joints[:, m.motor] + host.offset, host.motor_resolution, host.edge)
        load, leg = self.positions(m.load, joints), self.positions(m.leg, joints)
        force = self.servos.reported(joints[:, m.motor], speed[:, m.motor], state, held)
        return Course(command, echo, load, leg, force, motor, reading)


def rounded(x: Array, resolution: Array, edge: Array) -> Array:
    """Return `x` (..., k) at the nearest count, edges of encoders `edge` (k,) counts off the multiples; 0 is exact."""
    if not resolution.any():
        return x
    return np.asarray((np.rint(x / resolution - edge) + edge) * resolution)
