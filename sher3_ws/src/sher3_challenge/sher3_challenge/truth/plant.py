"""A truth plant ready to run: one robot as built, its faults, and its runs, recorded or ideal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_bags import Run
from sher3_description import Robot
from sher3_gap.excitation import Excitation

from sher3_challenge.truth.fault import Fault, Rig
from sher3_challenge.truth.parameters import AXES, Array, TruthParameters, copied
from sher3_challenge.truth.record import Condition, Timing, record
from sher3_challenge.truth.robot import individual, nominal, scatter


@dataclass(frozen=True)
class RunPlan:
    """One run of a case: what is driven, under which condition, with which seed."""

    excitation: Excitation
    repeat: int
    stamp: int
    seed: int


@dataclass(frozen=True)
class Climate:
    """Temperature over a whole case: it warms from `start` by `rise` [K] with a time constant [s]."""

    start: float
    rise: float
    constant: float
    origin: int

    def course(self, stamp: int) -> Callable[[Array], Array]:
        """Return temperature over a run's own time that starts at `stamp` [ns]."""
        since = (stamp - self.origin) * 1e-9
        return lambda t: np.asarray(self.start + self.rise * (1 - np.exp(-(since + t) / self.constant)))


@dataclass(frozen=True)
class Plant:
    """The truth plant of a case.

    Attributes:
        robot: the robot file in force.
        seed: fixes the individual.
        faults: what is wrong with it.
        climate: temperature over the case.
        tracker: whether the tip is tracked.
        built: False gives the robot exactly as its file says.
        region: (5,) positions about which the runs work, actuator units.
    """

    robot: Robot
    seed: int
    faults: Sequence[Fault]
    climate: Climate
    tracker: bool = True
    built: bool = True
    region: tuple[float, ...] = (0.0,) * AXES

    @cached_property
    def individual(self) -> TruthParameters:
        """The robot as built, before faults."""
        return individual(self.robot, np.random.default_rng(self.seed)) if self.built else nominal(self.robot)

    def rig(self, run_seed: int) -> Rig:
        """Return robot and transport of one run: a copy with the faults in it and the run's scatter."""
        rig = Rig(self.robot, copied(self.individual), region=np.array(self.region))
        for fault in self.faults:
            fault.apply(rig)
        if self.built:
            rig.truth = scatter(self.robot, rig.truth, np.random.default_rng((self.seed, run_seed)))
        return rig

    def run(self, plan: RunPlan, *, ideal: bool = False) -> Run:
        """Run a plan; `ideal` leaves out noise and rounding of the sensors, all else being the same."""
        rig = self.rig(plan.seed)
        if ideal:
            rig.truth.host.motor_resolution[:] = 0.0
            rig.truth.host.load_resolution[:] = 0.0
        timing = Timing(rig.delay, rig.jitter, rig.loss)
        condition = Condition(plan.stamp, self.climate.course(plan.stamp), self.tracker or ideal, ideal)
        return record(self.robot, rig.truth, timing, plan.excitation, plan.repeat, condition, plan.seed)

    def parameters(self) -> list[dict[str, float]]:
        """Return the parameters of each fault by the contract's names."""
        rig = Rig(self.robot, copied(self.individual), region=np.array(self.region))
        return [fault.apply(rig) for fault in self.faults]
