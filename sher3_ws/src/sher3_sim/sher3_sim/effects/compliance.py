"""Parts that give way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_sim.effects.base import SLIDERS, Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class TransmissionCompliance(Effect, id="transmission_compliance", family="compliance", stage="transmission"):
    """Screw, bearing or flexspline give way under the load they carry, weight and contact; too stiff to swing."""

    compliance: float = parameter("m/N", 1e-6, 0.0, 1e-4, "displacement of the load per force it carries")

    def apply(self, p: PlantParameters) -> None:
        """Soften the transmission."""
        p.axis["compliance"][self.rows] += self.compliance


@dataclass(frozen=True)
class StructuralCompliance(Effect, id="structural_compliance", family="compliance", stage="structure", places=("tip",)):
    """Rails, roll and arm bend under a wrench at the tip: a fraction of the lumped model of the paper's deflections.

    Lumped at the platform centre P: two springs in yaw and pitch, one along x (`sher3_kinematics.ArmCompliance`).
    """

    fraction: float = parameter("1", 0.2, 0.0, 3.0, "of the paper's structure")

    def apply(self, p: PlantParameters) -> None:
        """Soften the structure."""
        p.body["lumped_fraction"] += self.fraction
        p.body["gives_way"] = True


@dataclass(frozen=True)
class LinkCompliance(
    Effect, id="link_compliance", family="compliance", stage="structure", places=(*SLIDERS, "all", "tip")
):
    """The links of the delta stage, of a leg or of all, give way as a |F|^b: a fraction of the paper's measured law."""

    fraction: float = parameter("1", 0.5, 0.0, 10.0, "of the paper's link law with springs")

    def apply(self, p: PlantParameters) -> None:
        """Soften the links."""
        rows = self.rows if self.actuator in SLIDERS else [0, 1, 2]
        p.body["link_fraction"][0, rows] += self.fraction
        p.body["gives_way"] = True


@dataclass(frozen=True)
class ToolBending(Effect, id="tool_bending", family="compliance", stage="structure", places=("tip",)):
    """The tool is a thin needle: it bends under a force across its axis, not along it."""

    compliance: float = parameter("m/N", 50e-6, 0.0, 5e-3, "displacement of the tip per force across the tool")

    def apply(self, p: PlantParameters) -> None:
        """Soften the tool."""
        p.body["bending"] += self.compliance
        p.body["gives_way"] = True


@dataclass(frozen=True)
class StructuralVibration(Effect, id="structural_vibration", family="compliance", stage="structure", places=("tip",)):
    """The arm swings at its own frequency when the tip is accelerated."""

    frequency: float = parameter("Hz", 25.0, 1.0, 200.0, "of the undamped mode")
    damping: float = parameter("1", 0.03, 1e-3, 0.9, "damping ratio")
    amplitude: float = parameter("1", 1.0, 0.0, 20.0, "deflection per static deflection under the tip's acceleration")
    x: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along x of {b}")
    y: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along y of {b}")
    z: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along z of {b}")

    def apply(self, p: PlantParameters) -> None:
        """Add the mode."""
        p.body["mode_frequency"] = self.frequency
        p.body["mode_damping"] = self.damping
        p.body["mode_gain"] = self.amplitude * np.array([self.x, self.y, self.z])
