"""The lumped truth plant ready to run: one robot as built, its faults, its motion, and what its force sensor reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.signal import lfilter
from sher3_bags import Run
from sher3_description import Robot
from sher3_description.contract import GRAVITY, REFERENCE_TEMPERATURE
from sher3_gap.excitation import Excitation

from sher3_challenge.plants.arrays import copied
from sher3_challenge.plants.lumped.hysteresis import ELEMENTS, drag_anchors, slip_state
from sher3_challenge.plants.lumped.loop import Script, run_loop
from sher3_challenge.plants.lumped.parameters import AXES, Array, Sensors, TruthParameters
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.lumped.robot import bend, individual, nominal, scatter
from sher3_challenge.plants.lumped.tip import follow_tip
from sher3_challenge.plants.plant import Plant, RunPlan
from sher3_challenge.plants.recorder import Signals, recorded


@dataclass(frozen=True)
class LumpedPlant(Plant):
    """The truth plant of formulae with few elements."""

    @cached_property
    def individual(self) -> TruthParameters:
        """The robot as built, before faults."""
        if not self.built:
            return nominal(self.robot)
        return individual(self.robot, np.random.default_rng(self.seed), self.level)

    def rig(self) -> Rig:
        """Return a copy of the robot as built."""
        return Rig(self.robot, copied(self.individual), region=np.array(self.region))

    def faulty(self, run_seed: int) -> Rig:
        """Return robot and transport of one run: a copy with the faults in it and the run's scatter."""
        rig = self.rig()
        for fault in self.faults:
            fault.apply(rig)
        if self.built:
            bend(rig.truth, self.level.bend(self.seed))
            rig.truth = scatter(self.robot, rig.truth, np.random.default_rng((self.seed, run_seed)))
        return rig

    def run(self, plan: RunPlan, *, ideal: bool = False) -> Run:
        """Run a plan; `ideal` leaves out noise and rounding of the sensors, all else being the same."""
        rig = self.faulty(plan.seed)
        if ideal:
            rig.truth.host.motor_resolution[:] = 0.0
            rig.truth.host.load_resolution[:] = 0.0
        rng = np.random.default_rng(plan.seed)
        warmth = self.climate.course(plan.stamp)(plan.excitation.time)
        signals = signals_of(self, rig, plan.excitation, warmth, rng)
        return recorded(self.robot, plan, signals, rng, tracker=self.tracker or ideal, ideal=ideal)


def signals_of(
    plant: Plant,
    rig: Rig,
    excitation: Excitation,
    temperature: Array,
    rng: np.random.Generator,
) -> Signals:
    """Run the plant over an excitation at the given temperature (n,) [degC]; return what the sensors would see."""
    robot, p = plant.robot, rig.truth
    n, period = len(excitation.position), robot.control_period
    contact = np.ascontiguousarray(excitation.contact_wrench()[:, :3], dtype=np.float64)
    glitches: Array = (
        p.host.glitch * (rng.random((n, AXES)) < p.host.glitch_probability) * rng.choice([-1.0, 1.0], (n, AXES))
    )
    glitches[:5] = 0.0
    script = Script(
        np.ascontiguousarray(excitation.position),
        np.ascontiguousarray(excitation.velocity),
        contact,
        rig.timing.draw(n, period, rng),
        glitches,
        np.where(rng.random(AXES) < 0.5, -1.0, 1.0),
        period,
    )
    course = run_loop(p, rig.foreign, script)
    kelvin = temperature - REFERENCE_TEMPERATURE
    tips, turns = follow_tip(p.geometry, course.load, contact, kelvin, period)
    wrench = force_sensor(robot, p.sensors, turns, course.load, contact, kelvin)
    tips, wrench = plant.behind(rig.foreign, course.load, course.force, contact, tips, wrench)
    return Signals(
        course.command, course.echo, course.motor_reading, course.load_reading, course.force, wrench,
        tips + p.sensors.tracker_bias, turns, temperature,
    )  # fmt: skip


def force_sensor(
    robot: Robot,
    p: Sensors,
    turns: Array,
    q: Array,
    contact: Array,
    kelvin: Array,
) -> Array:
    """Return (n, 6) what the force sensor would read in {f} without noise and rounding.

    Args:
        robot: nominal robot, for the sensor's place.
        p: the sensor as it is.
        turns: (n, 3, 3) rotation of {t} in {b}.
        q: (n, 5) true load positions, for the cable.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
    """
    sensor = robot.force_sensor
    force = np.einsum("nji,nj->ni", turns, contact)
    weight = -p.tool_mass[0] * GRAVITY * turns[:, 2, :]
    torque = np.cross(-np.asarray(sensor.position), force) + np.cross(p.tool_com, weight)
    wrench = np.hstack([force + weight, torque])
    wrench[:, 0] += p.cable_force[1] * q[:, 4] / robot.tilt_linkage.crank
    wrench[:, 1] += p.cable_force[0] * q[:, 3] + p.cable_force[2] * _loop(q[:, 3], p.cable_force[3])
    wrench = p.force_scale[0] * wrench @ p.crosstalk.T + p.force_bias + np.outer(kelvin, p.force_drift)
    if p.force_lag[0] > 0.0:
        keep = np.exp(-robot.control_period / p.force_lag[0])
        wrench = lfilter([1 - keep], [1, -keep], wrench, axis=0, zi=keep * wrench[:1])[0]
    return np.asarray(wrench)


def _loop(x: Array, reach: float) -> Array:
    anchor = np.full(ELEMENTS, x[0])
    out = np.empty_like(x)
    for k, value in enumerate(x):
        out[k] = slip_state(value, anchor, reach)
        drag_anchors(value, anchor, reach)
    return out
