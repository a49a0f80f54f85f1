"""Structural compliance: the arm gives way under a load on the tip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_kinematics.tip_deflection import ArmCompliance
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.compliance.stiffening import FINER, softness, stiffened
from sher3_effects.page import Page, Tolerated
from sher3_effects.view import RobotView

_ARM = ArmCompliance()


class StructuralCompliance(Page):
    """A share of the paper's lumped compliance: rotation springs about y and z at the platform and a spring along x."""

    id, family, stage = "structural_compliance", "compliance", "structure"
    inputs = ("load", "posture")
    seen_at = (("structure", "tip"),)
    best = Best("loads", "known loads in several postures separate springs")
    places = ("tip",)
    explanation = (
        "A force on the tip displaces and turns it in proportion, most across the arm, as if the arm were "
        "hinged at the platform with springs."
    )
    siblings = {
        "tool_bending": "only across the tool",
        "link_compliance": "softer at small forces",
        "transmission_compliance": "the load encoders see it",
    }
    units = {"x": "m/N", "y": "rad/(N*m)", "z": "rad/(N*m)", "stiffens": "N"}
    finer = FINER
    tried = ({"free": 0.0}, {"free": 1.0})
    """The paper's ratios, or three free springs."""
    LUMPED = (_ARM.along_x, 1.0 / _ARM.pitch, 1.0 / _ARM.yaw)
    """Along x, about y, about z, of the deflection table less the delta's own share [m/N, rad/(N m), rad/(N m)]."""

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Return the shape with each force at which the compliance of an arm that stiffens is halved."""
        return stiffened(shape)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Return displacement and turn of the tip (g, 6, 1) of the lumped arm, or (g, 6, 3) of three free springs."""
        lever, force = view.lever, view.path.contact
        moment = np.cross(lever, force)
        parts = np.zeros((len(lever), 6, 3))
        parts[:, 0, 0] = force[:, 0]
        for j in (1, 2):
            turn = np.zeros_like(moment)
            turn[:, j] = moment[:, j]
            parts[:, :3, j], parts[:, 3:, j] = np.cross(turn, lever), turn
        lumped = parts @ np.array(self.LUMPED)
        columns = (parts if shape["free"] else lumped[:, :, None]) * softness(force, shape)
        return Signature({Channel("structure", "tip"): columns} if view.run.tracker_position is not None else {})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the share of the lumped model."""
        return (Tolerated({"free": 0.0}, {"structural compliance": (robot.tolerances.compliance, "1")}),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the share of the paper's compliance, springs that were free, and what halves them if they stiffen.

        Coefficients: the share (1,), or the springs (3,) along x [m/N] and about y and z [rad/(N m)].
        """
        bend = {n: x for n, x in shape.items() if n == "stiffens"}
        if len(coefficients) == 1:
            return {"fraction": float(coefficients[0]), **bend}
        share = float(np.mean(coefficients / np.array(self.LUMPED)))
        return {"fraction": share, **{n: float(c) for n, c in zip("xyz", coefficients, strict=True)}, **bend}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether every spring gives way to the force: no compliance of (p,) is below -2 % of the largest."""
        return bool((coefficients >= -0.02 * np.abs(coefficients).max()).all())


@dataclass(frozen=True)
class StructuralComplianceInPlant(PlantEffect, page=StructuralCompliance):
    """Rails, roll and arm bend under a wrench at the tip: a fraction of the lumped model of the paper's deflections.

    Lumped at the platform centre P: two springs in yaw and pitch, one along x (`sher3_kinematics.ArmCompliance`).
    """

    fraction: float = parameter("1", 0.2, 0.0, 3.0, "of the paper's structure")

    def apply(self, p: PlantParameters) -> None:
        """Soften the structure."""
        p.body["lumped_fraction"] += self.fraction
        p.body["gives_way"] = True
