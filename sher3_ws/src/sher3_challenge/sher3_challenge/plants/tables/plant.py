"""The tables plant ready to run: one robot as built, its faults, and its runs, recorded or ideal."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from sher3_bags import Run
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE

from sher3_challenge.plants.arrays import copied
from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.plant import AXES, Array, Plant, RunPlan
from sher3_challenge.plants.recorder import Signals, recorded
from sher3_challenge.plants.tables.loop import Script, run_loop
from sher3_challenge.plants.tables.parameters import TableParameters
from sher3_challenge.plants.tables.robot import bend, individual, nominal, scatter
from sher3_challenge.plants.tables.sensing import force_reading
from sher3_challenge.plants.tables.tip import tip_of
from sher3_challenge.plants.tables.transport import Transport
from sher3_challenge.plants.tables.warmth import temperatures


@dataclass
class Rig:
    """What a fault may change: parameters and transport. `region` is where the runs work, for local faults."""

    robot: Robot
    truth: TableParameters
    transport: Transport = field(default_factory=Transport)
    foreign: Foreign = NOTHING
    region: Array = field(default_factory=lambda: np.zeros(AXES))


@dataclass(frozen=True)
class TablesPlant(Plant):
    """The truth plant of sampled laws."""

    @cached_property
    def individual(self) -> TableParameters:
        """The robot as built, before faults."""
        if not self.built:
            return nominal(self.robot)
        return individual(self.robot, np.random.default_rng((3, self.seed)), self.level)

    def rig(self) -> Rig:
        """Return a copy of the robot as built."""
        return Rig(self.robot, copied(self.individual), region=np.array(self.region))

    def run(self, plan: RunPlan, *, ideal: bool = False) -> Run:
        """Run a plan; `ideal` leaves out noise and rounding of the sensors, all else being the same."""
        rig = self.rig()
        for fault in self.faults:
            fault.apply(rig)
        if self.built:
            bend(rig.truth, self.level.bend(self.seed))
            rig.truth = scatter(self.robot, rig.truth, np.random.default_rng((3, self.seed, plan.seed)))
        p, e, rng = rig.truth, plan.excitation, np.random.default_rng((3, plan.seed))
        if ideal:
            p.host.motor_count[:] = p.host.load_count[:] = 0.0
        contact = p.tip.strength[0] * np.ascontiguousarray(e.contact_wrench()[:, :3], dtype=np.float64)
        period = self.robot.control_period
        script = Script(
            np.ascontiguousarray(e.position), np.ascontiguousarray(e.velocity), contact,
            rig.transport.arrivals(len(contact), period, rng), np.where(rng.random(AXES) < 0.5, -1.0, 1.0), period,
        )  # fmt: skip
        course = run_loop(p, rig.foreign, script)
        room, body = temperatures(self.climate, plan.stamp, e.time)
        kelvin = body - REFERENCE_TEMPERATURE
        tips, turns = tip_of(self.robot, p, course.load, contact, kelvin, period)
        wrench = force_reading(self.robot, p, turns, course.load, contact, kelvin)
        tips, wrench = self.behind(rig.foreign, course.load, course.force, contact, tips, wrench)
        signals = Signals(
            course.command, course.echo, course.motor_reading, course.load_reading, course.force, wrench, tips, turns,
            room,
        )  # fmt: skip
        return recorded(self.robot, plan, signals, rng, tracker=self.tracker or ideal, ideal=ideal)
