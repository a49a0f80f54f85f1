"""The seam between the challenge and a truth plant: what a run is asked for, what a plant answers, what it is made of.

A folder `sher3_challenge/plants/NAME` with a module `truth.py` that defines `PLANT = TruthPlant(...)` is a plant.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run
from sher3_description import ACTUATORS, Robot
from sher3_gap.excitation import Excitation

from sher3_challenge.errors import ChallengeError
from sher3_challenge.oracle import nominal
from sher3_challenge.plants.grammar import ON_SENSOR, ON_TIP, Foreign, added
from sher3_challenge.plants.kinds import Fault, Kind
from sher3_challenge.plants.level import EXACT, Level
from sher3_challenge.plants.site import ANGULAR

Array = NDArray[np.floating[Any]]
Behind = tuple[Array, Array]
AXES = 5
SCALE = np.array([1e-3 * (ANGULAR["length"] if name == "roll" else 1.0) for name in ACTUATORS])
"""Travel over which laws behind the axes may bend: a millimetre of a slider."""


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
        """Return temperature (n,) over a run's own time (n,) [s] that starts at `stamp` [ns]."""
        since = (stamp - self.origin) * 1e-9
        return lambda t: np.asarray(self.start + self.rise * (1 - np.exp(-(since + t) / self.constant)))


@dataclass(frozen=True)
class Plant(ABC):
    """One robot of a truth plant with its faults; a base for the plants, which add their laws.

    Attributes:
        robot: the robot file in force.
        seed: fixes the individual.
        faults: what is wrong with it, of kinds of the same truth plant.
        climate: temperature over the case.
        tracker: whether the tip is tracked.
        built: False gives the robot exactly as its file says, with nothing that scatters from run to run.
        region: (5,) positions about which the runs work, actuator units, for faults in one place of a stroke.
    """

    robot: Robot
    seed: int
    faults: Sequence[Fault]
    climate: Climate
    tracker: bool = True
    built: bool = True
    region: tuple[float, ...] = (0.0,) * AXES

    @cached_property
    def level(self) -> Level:
        """How imperfect this robot is."""
        return Level.drawn(self.seed) if self.built else EXACT

    def behind(self, law: Foreign, load: Array, force: Array, contact: Array, tip: Array, wrench: Array) -> Behind:
        """Return tip (n, 3) and force reading (n, 6) with the robot's bends and its foreign law, if it has one there.

        Args:
            law: foreign law of the robot.
            load: (n, 5) true positions of the axes.
            force: (n, 5) forces of their drives.
            contact: (n, 3) force at the tip in {b}.
            tip: as mechanism and structure make it by their pages.
            wrench: as the sensor makes it.
        """
        period = self.robot.control_period
        if self.level.shape:
            position, rotation = nominal.tip_pose(self.robot, load)
            inputs = np.hstack([load / SCALE, contact])
            tip = self.level.bent(self.seed, position, tip, inputs)
            wrench = self.level.bent(self.seed, nominal.force_reading(self.robot, rotation, contact), wrench, inputs)
        tip = added(law, ON_TIP, tip, load, force, period)
        return tip, added(law, ON_SENSOR, wrench, load, force, period)

    @abstractmethod
    def run(self, plan: RunPlan, *, ideal: bool = False) -> Run:
        """Run a plan; `ideal` leaves out noise and rounding of the sensors and tracks the tip, all else the same."""

    @abstractmethod
    def rig(self) -> Any:
        """Return the robot as built between its runs, a copy that its faults are written into."""

    def parameters(self) -> list[dict[str, float]]:
        """Return the parameters of each fault by the contract's names."""
        rig = self.rig()
        return [fault.apply(rig) for fault in self.faults]


@dataclass(frozen=True)
class TruthPlant:
    """A truth plant as the challenge sees it.

    Attributes:
        name: name of its folder.
        summary: one line that tells it from the others.
        library: kinds of faults that stand for the effect ids of the contract, all of them, by name.
        outside: kinds that no catalogue names.
        make: its class of `Plant`; called with the fields of `Plant`.
    """

    name: str
    summary: str
    library: Mapping[str, Kind]
    outside: Mapping[str, Kind]
    make: type[Plant]

    @property
    def effects(self) -> tuple[str, ...]:
        """Return the effect ids that some kind stands for, sorted."""
        return tuple(sorted({kind.effect for kind in self.library.values()}))

    def kind(self, name: str) -> Kind:
        """Return the kind of that name; raises ChallengeError."""
        for catalogue in (self.library, self.outside):
            if name in catalogue:
                return catalogue[name]
        raise ChallengeError.unknown("no such fault", name, [*self.library, *self.outside])
