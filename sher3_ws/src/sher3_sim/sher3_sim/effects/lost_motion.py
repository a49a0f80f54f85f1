"""Motion that is lost on reversal."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_sim.effects.base import SLIDERS, Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class Backlash(Effect, id="backlash", family="lost_motion", stage="transmission"):
    """A gap between motor and load: after a reversal the load waits until the motor has crossed it."""

    width: float = parameter("m", 5e-6, 0.0, 1e-3, "of the gap")

    def apply(self, p: PlantParameters) -> None:
        """Widen the gap."""
        p.axis["backlash"][self.rows] += self.width


@dataclass(frozen=True)
class TransmissionHysteresis(Effect, id="transmission_hysteresis", family="lost_motion", stage="transmission"):
    """After a reversal the load lags and catches up gradually: friction inside an elastic transmission."""

    width: float = parameter("m", 5e-6, 0.0, 1e-3, "of the loop, between the two directions")
    displacement: float = parameter("m", 20e-6, 1e-8, 1e-2, "travel over which it turns to 1/e")

    def apply(self, p: PlantParameters) -> None:
        """Widen the loop."""
        p.axis["hysteresis"][self.rows] += self.width
        p.axis["hysteresis_displacement"][self.rows] = self.displacement


@dataclass(frozen=True)
class JointClearance(Effect, id="joint_clearance", family="lost_motion", stage="mechanism", places=SLIDERS):
    """The ball joints of a leg have play: the leg is longer under tension than under compression by the clearance."""

    clearance: float = parameter("m", 10e-6, 0.0, 1e-3, "length between tension and compression")

    def apply(self, p: PlantParameters) -> None:
        """Give the leg play."""
        p.axis["clearance"][self.rows] += self.clearance
        p.body["gives_way"] = True
