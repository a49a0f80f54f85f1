"""Ratios that are not what the model says."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_sim.effects.base import EVERYWHERE, Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class ControllerGain(Effect, id="controller_gain", family="scale", stage="controller", places=EVERYWHERE):
    """The host's position gain is not the one configured: wrong unit, wrong file, rounding."""

    relative: float = parameter("1", 0.1, -0.9, 4.0, "gain over nominal gain, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the position gain."""
        p.axis["position_gain"][self.rows] *= 1.0 + self.relative


@dataclass(frozen=True)
class TorqueConstant(Effect, id="torque_constant", family="scale", stage="motor_mechanics", places=EVERYWHERE):
    """The force on the axis is not the force the drive reports: weak magnets, wrong constant, losses."""

    relative: float = parameter("1", 0.05, -0.5, 1.0, "force over reported effort, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the force on the motor."""
        p.axis["torque_scale"][self.rows] *= 1.0 + self.relative


@dataclass(frozen=True)
class LeadError(Effect, id="lead_error", family="scale", stage="transmission"):
    """The load moves by a constant ratio more than the motor encoder says: lead of the screw, reduction."""

    relative: float = parameter("1", 1e-3, -0.05, 0.05, "load over motor travel, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the load's travel."""
        p.axis["lead_error"][self.rows] += self.relative


@dataclass(frozen=True)
class EncoderScale(Effect, id="encoder_scale", family="scale", stage="sensing"):
    """The load encoder's scale is wrong: it reads more than the load moves."""

    relative: float = parameter("1", 1e-3, -0.05, 0.05, "reading over load travel, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the load encoder."""
        p.axis["encoder_scale"][self.rows] += self.relative


@dataclass(frozen=True)
class ForceScale(Effect, id="force_scale", family="scale", stage="sensing", places=("force_sensor",)):
    """The force sensor's gain is wrong, in all its channels or in some."""

    relative: float = parameter("1", 0.05, -0.5, 1.0, "reading over wrench, less one")
    axis: float = parameter("1", -1.0, -2.0, 5.0, "component of (force, torque) it is of; -1 all, -2 the forces")

    def apply(self, p: PlantParameters) -> None:
        """Scale the sensor's matrix, or rows of it."""
        chosen = round(self.axis)
        rows = slice(None) if chosen == -1 else slice(0, 3) if chosen == -2 else slice(chosen, chosen + 1)
        p.body["wrench_matrix"][0, rows] *= 1.0 + self.relative
