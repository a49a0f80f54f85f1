"""Timing of the command's way to the drive."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_sim.effects.base import EVERYWHERE, Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class CommandDelay(Effect, id="command_delay", family="timing", stage="transport", places=EVERYWHERE):
    """Every command acts a constant time after it was published: bus cycle, buffers, computing time."""

    delay: float = parameter("s", 1e-3, 0.0, 0.03, "dead time of the command")

    def apply(self, p: PlantParameters) -> None:
        """Delay the commands."""
        p.axis["delay"][self.rows] += self.delay


@dataclass(frozen=True)
class CommandJitter(Effect, id="command_jitter", family="timing", stage="transport", places=EVERYWHERE):
    """Commands arrive late by a random time, half-normal and the same for all axes of a tick; order is kept."""

    sigma: float = parameter("s", 3e-4, 0.0, 0.01, "scale of the lateness |N(0, sigma)|")

    def apply(self, p: PlantParameters) -> None:
        """Scatter the arrival times."""
        p.axis["jitter"][self.rows] += self.sigma


@dataclass(frozen=True)
class DroppedCommands(Effect, id="dropped_commands", family="timing", stage="transport", places=EVERYWHERE):
    """Some ticks' commands never arrive, for all axes at once; the drives hold the last one."""

    probability: float = parameter("1", 0.01, 0.0, 0.9, "chance that the command of a tick is lost")

    def apply(self, p: PlantParameters) -> None:
        """Lose commands."""
        p.axis["drop"][self.rows] = 1.0 - (1.0 - p.axis["drop"][self.rows]) * (1.0 - self.probability)


@dataclass(frozen=True)
class DriveLag(Effect, id="drive_lag", family="timing", stage="drive", places=EVERYWHERE):
    """The drive's force follows its law with a first-order lag: current loop or filter."""

    time_constant: float = parameter("s", 1e-3, 0.0, 0.02, "of the lag")

    def apply(self, p: PlantParameters) -> None:
        """Lag the force."""
        p.axis["lag"][self.rows] += self.time_constant


@dataclass(frozen=True)
class AxisSkew(Effect, id="axis_skew", family="timing", stage="transport"):
    """One axis acts later than the others: its frame is the last of the bus cycle."""

    skew: float = parameter("s", 1e-3, 0.0, 0.03, "lateness against the other axes")

    def apply(self, p: PlantParameters) -> None:
        """Delay one axis."""
        p.axis["delay"][self.rows] += self.skew
