"""The lumped truth plant ready to run: one robot as built, its faults, and its runs, recorded or ideal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_bags import Run

from sher3_challenge.plants.arrays import copied
from sher3_challenge.plants.lumped.motion import signals_of
from sher3_challenge.plants.lumped.parameters import TruthParameters
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.lumped.robot import bend, individual, nominal, scatter
from sher3_challenge.plants.plant import Plant, RunPlan
from sher3_challenge.plants.recorder import recorded


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
