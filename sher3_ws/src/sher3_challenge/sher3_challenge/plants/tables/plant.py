"""The tables plant ready to run: one robot as built, its faults, and its runs, recorded or ideal.

Commands have delays that waver, lateness from an empirical distribution, and losses in bursts. The room warms with two
time constants, and the body of the robot lags behind the room.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from sher3_bags import Run
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE

from sher3_challenge.plants.arrays import copied
from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.plant import AXES, Array, Climate, Plant, RunPlan
from sher3_challenge.plants.recorder import Signals, recorded
from sher3_challenge.plants.tables.loop import Script, run_loop
from sher3_challenge.plants.tables.parameters import TableParameters
from sher3_challenge.plants.tables.robot import bend, individual, nominal, scatter
from sher3_challenge.plants.tables.sensing import force_reading
from sher3_challenge.plants.tables.tip import tip_of

LATENESS = np.interp(np.linspace(0, 1, 65), [0, 0.1, 0.5, 0.8, 0.95, 1], [0.0, 0.25, 0.75, 1.2, 2.0, 3.6])
"""Quantiles of a command's lateness over its scale, as measured on a busy bus: never quite none, with a long tail."""
LATENESS /= np.sqrt(np.mean(np.interp(np.linspace(0, 1, 4001), np.linspace(0, 1, 65), LATENESS) ** 2))
WAVER = 0.02
"""Share by which a constant delay wavers slowly."""
BURST = 1.6
"""Mean number of commands lost in a row."""
FAST_SHARE, FAST = 0.2, 0.2
"""Share of the rise that comes fast, and its time constant over the climate's own."""
LAG = 15.0
"""Time by which the body lags behind the room [s], against some 260 s of a case."""


@dataclass
class Transport:
    """Delay per axis [s], rms of a random lateness [s], share of commands that are lost."""

    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    lateness: float = 0.0
    loss: float = 0.0

    def arrivals(self, ticks: int, period: float, rng: np.random.Generator) -> Array:
        """Return (ticks, 5) times of arrival [s] from the start, inf where a command is lost; none overtakes."""
        tick = np.arange(ticks)
        drawn = np.interp(rng.random(ticks), np.linspace(0, 1, len(LATENESS)), LATENESS)
        slow = 1 + WAVER * np.sin(2 * np.pi * (tick * period * 0.7 + rng.random()))
        late = np.minimum(self.lateness * drawn, 5 * period)
        arrival = (tick * period)[:, None] + late[:, None] + slow[:, None] * self.delay
        arrival = np.maximum.accumulate(arrival, axis=0)
        lost = np.zeros(ticks, dtype=bool)
        if self.loss > 0.0:
            begins = rng.random(ticks) < self.loss / BURST
            for start in np.flatnonzero(begins):
                lost[start : start + rng.geometric(1 / BURST)] = True
        lost[0] = False
        arrival[lost] = np.inf
        return np.asarray(arrival)


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


def temperatures(climate: Climate, stamp: int, time: Array) -> tuple[Array, Array]:
    """Return what thermometer and body have, (n,) each [degC], over a run's own time, which starts at `stamp` [ns]."""
    since = np.maximum(0.0, (stamp - climate.origin) * 1e-9 + time)
    room, body = np.full(len(time), climate.start), np.full(len(time), climate.start)
    for share, constant in ((1 - FAST_SHARE, climate.constant), (FAST_SHARE, FAST * climate.constant)):
        slow = np.exp(-since / constant)
        room += climate.rise * share * (1 - slow)
        lagged = (constant * slow - LAG * np.exp(-since / LAG)) / (constant - LAG)
        body += climate.rise * share * (1 - lagged)
    return room, body
