"""The MuJoCo plant ready to run: one robot as built, its faults, its motion, and what its force sensor reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_bags import Run
from sher3_description import Robot
from sher3_description.contract import GRAVITY, REFERENCE_TEMPERATURE

from sher3_challenge.plants.mujoco.axes.field import field_along
from sher3_challenge.plants.mujoco.axes.loop import Script, run_loop
from sher3_challenge.plants.mujoco.axes.parts import AXES, Array, Bristle
from sher3_challenge.plants.mujoco.axes.transport import arrivals
from sher3_challenge.plants.mujoco.built import as_drawn, bend, deviate, on_the_day
from sher3_challenge.plants.mujoco.mechanism import tilt_angle
from sher3_challenge.plants.mujoco.rig import Rig, Sensor
from sher3_challenge.plants.mujoco.tip import follow
from sher3_challenge.plants.plant import Plant, RunPlan
from sher3_challenge.plants.recorder import Signals, recorded

SOAK = 4.0
"""Seconds by which the mechanism is behind the thermometer."""


@dataclass(frozen=True)
class MujocoPlant(Plant):
    """The truth plant whose axes and structure are moved by MuJoCo."""

    def rig(self) -> Rig:
        """Return the robot as built."""
        rig = as_drawn(self.robot)
        rig.region = np.array(self.region)
        if self.built:
            deviate(rig, np.random.default_rng(self.seed), self.level)
        return rig

    def faulty(self) -> Rig:
        """Return the robot with its faults, as it is between the runs."""
        rig = self.rig()
        friction = [axis.coulomb for axis in rig.axes]
        for fault in self.faults:
            fault.apply(rig)
        if self.built:
            bend(rig, self.level.bend(self.seed), friction)
        rig.host.foreign = rig.foreign
        return rig

    def run(self, plan: RunPlan, *, ideal: bool = False) -> Run:
        """Run a plan; `ideal` leaves out noise and rounding of the sensors, all else being the same."""
        rig = self.faulty()
        if self.built:
            on_the_day(rig, np.random.default_rng((self.seed, plan.seed)))
        if ideal:
            rig.host.motor_resolution = rig.host.load_resolution = np.zeros(AXES)
        rng = np.random.default_rng(plan.seed)
        signals = self._signals(rig, plan, rng)
        return recorded(self.robot, plan, signals, rng, tracker=self.tracker or ideal, ideal=ideal)

    def _signals(self, rig: Rig, plan: RunPlan, rng: np.random.Generator) -> Signals:
        e, period = plan.excitation, self.robot.control_period
        contact = np.asarray(rig.known_load * e.contact_wrench()[:, :3], dtype=np.float64)
        arrival = arrivals(len(e.position), period, rig.host.delay, rig.host.jitter, rig.host.loss, rng)
        side = np.where(rng.random(AXES) < 0.5, -1.0, 1.0)
        field = field_along(self.robot, e.position, contact)
        course = run_loop(rig.axes, rig.host, Script(e.position, e.velocity, field, arrival, side, period))
        warmth = self.climate.course(plan.stamp)
        temperature = warmth(e.time)
        soaked = warmth(e.time - SOAK) - REFERENCE_TEMPERATURE
        tip, turn = follow(self.robot, rig.mechanism, rig.yielding, course.leg, contact, soaked)
        angle = tilt_angle(rig.mechanism, course.leg[:, 4])
        kelvin = temperature - REFERENCE_TEMPERATURE
        wrench = force_reading(self.robot, rig.sensor, turn, course.load[:, 3], angle, contact, kelvin)
        tip, wrench = self.behind(rig.foreign, course.load, course.force, contact, tip, wrench)
        return Signals(
            course.command, course.echo, course.motor_reading, course.load_reading, course.force, wrench, tip,
            turn.as_matrix(), temperature,
        )  # fmt: skip


def force_reading(
    robot: Robot, s: Sensor, turn: Rotation, roll: Array, angle: Array, contact: Array, kelvin: Array
) -> Array:
    """Return (n, 6) readings in {f}.

    Args:
        robot: nominal robot, for the sensor's place.
        s: the sensor as it is.
        turn: n rotations of {t} in {b}.
        roll: (n,) roll [rad], which winds the cable.
        angle: (n,) tilt [rad].
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
    """
    force = turn.apply(contact, inverse=True)
    weight = turn.apply([0.0, 0.0, -s.tool_mass * GRAVITY], inverse=True)
    torque = np.cross(-np.asarray(robot.force_sensor.position), force) + np.cross(s.tool_com, weight)
    wrench = np.hstack([force + weight, torque])
    wrench[:, 0] += s.cable[1] * angle
    wrench[:, 1] += s.cable[0] * roll
    for bristle in s.cable_bristles:
        wrench[:, 1] += dragged(bristle, roll)
    wrench = wrench @ s.matrix.T + s.bias + np.outer(kelvin, s.drift)
    return late(wrench, s.late, robot.control_period)


def dragged(bristle: Bristle, x: Array) -> Array:
    """Return (n,) the force of a bristle whose foot slips: between -force and force."""
    foot, out = x[0], np.empty_like(x)
    for k, value in enumerate(x):
        foot = min(value + bristle.reach, max(value - bristle.reach, foot))
        out[k] = (value - foot) / bristle.reach
    return bristle.force * out


def late(wrench: Array, delay: Array, period: float) -> Array:
    """Return the channels as they were `delay` (6,) seconds ago, linear between the ticks."""
    if not delay.any():
        return wrench
    time = period * np.arange(len(wrench))
    return np.column_stack([np.interp(time - d, time, wrench[:, i]) for i, d in enumerate(delay)])
