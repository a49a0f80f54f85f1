"""Gear loss: friction in proportion to the load on the gear."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class GearLoss(Page):
    """F = z (force + share * |nominal force|), z the direction of motion.

    A model whose friction does not follow the load takes that at the mean load, `usual`.
    """

    id, family, stage = "gear_loss", "friction", "motor_mechanics"
    inputs = ("direction", "force")
    kinds = ("joint",)
    dry = True
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    extends = ("coulomb_friction",)
    extends_by = ("share",)
    explanation = (
        "The teeth rub the more the heavier they are loaded: the step at a reversal grows with the force that the "
        "joint carries there."
    )
    siblings = {
        "coulomb_friction": "the same step in every posture",
        "torque_constant": "all forces are scaled, at rest and in both directions alike",
    }
    units = {"force": "N", "share": "1", "usual": "N"}
    on_axis = {"usual": "coulomb", "share": "load_loss"}
    DISPLACEMENT = 2.5e-3
    """Over which the direction reverses, in motor revolutions: the middle one of Coulomb friction."""

    def carried(self, view: AxisView, row: int) -> Array:
        """Return the load on the contact, (g,), N or N m: the size of the force that the joint carries."""
        return np.abs(view.inertial[:, row])

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return without (0) and with (1) friction that is there without load, and the mean load."""
        row = views[0].row(site)
        load = float(np.mean(np.concatenate([self.carried(v, row) for v in views])))
        return [{"dry": 0.0, "load": load}, {"dry": 1.0, "load": load}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the direction times the force that the joint carries, and the direction alone."""
        row = view.row(site)
        z = view.run.to_grid(view.sliding(row, self.DISPLACEMENT * view.lead(site))[:, None])[:, 0]
        lost = z * self.carried(view, row)
        return Signature({Channel(self.stage, site): column(lost, z) if shape["dry"] else column(lost)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the share of the load that is lost, the friction without load, and that at the mean load.

        Coefficients: the share (1,), with a friction without load two (2,).
        """
        share, dry = float(coefficients[0]), float(coefficients[1]) if shape["dry"] else 0.0
        return {"share": share, **({"force": dry} if shape["dry"] else {}), "usual": dry + share * shape["load"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether less than all of the load, the first of (p,), is lost, and friction resists."""
        return bool(0.0 < coefficients[0] < 1.0 and (not shape["dry"] or coefficients[1] > 0.0))


class LossUnderLoad(GearLoss):
    """The same on one axis under a known force from outside: a seal under pressure, a nut or a guide under a load."""

    kinds, needs = ("axis",), ("applied",)
    inputs = ("direction", "load")
    explanation = (
        "A seal, a nut or a guide rubs the more the heavier it is pressed: the step at a reversal grows with the known "
        "force on the axis."
    )
    LEAST = 0.1
    """Share by which the load must differ over the records, at least: else it is a dry friction."""

    def carried(self, view: AxisView, row: int) -> Array:
        """Return the size of the known force from outside, (g,)."""
        return np.abs(view.path.contact_force[:, row])

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return those of every joint where the load differs."""
        row = views[0].row(site)
        load = np.concatenate([self.carried(v, row) for v in views])
        return super().shapes(views, site) if load.std() > self.LEAST * load.mean() > 0.0 else []
