"""Viscous friction: a force in proportion to speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.page import Page, Tolerated
from sher3_effects.view import AxisView, NominalAxis


class ViscousFriction(Page):
    """F = extra * v."""

    id, family, stage = "viscous_friction", "friction", "motor_mechanics"
    inputs = ("velocity",)
    gives = ("extra",)
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    leaves_out = "that a lubricant thins with speed and warmth"
    explanation = (
        "The axis needs more force the faster it moves, in proportion: lubricant or seals are stiffer than "
        "the model says."
    )
    siblings = {
        "coulomb_friction": "the force does not depend on speed",
        "torque_constant": "all forces are scaled, gravity too",
    }
    on_axis = {"extra": "viscous"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: the motor velocity."""
        return Signature({Channel(self.stage, site): column(view.velocity[:, view.row(site)])})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the viscous coefficient of the axis."""
        limit = robot.tolerances.viscous * robot.actuators[ACTUATORS.index(site)].viscous
        unit = self.unit("extra", site, site == "roll")
        return (Tolerated({}, {f"viscous coefficient of {site}": (limit, unit)}),)


class ViscousOnAxis(ViscousFriction):
    """The same on one axis of any machine: with the nominal one it never pushes along.

    Attributes:
        nominal: viscous coefficient that the description states, N/(m/s) or N m/(rad/s).
    """

    kinds = ("axis",)
    plain = True

    def __init__(self, nominal: float = 0.0) -> None:
        self.nominal = nominal

    def on(self, axis: NominalAxis) -> ViscousOnAxis:
        """Return the page with the coefficient of the axis."""
        return ViscousOnAxis(axis.viscous)

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the friction, the stated and the found coefficient (1,) together, resists."""
        return bool(coefficients[0] > -self.nominal)


@dataclass(frozen=True)
class ViscousFrictionInPlant(PlantEffect, page=ViscousFriction):
    """Friction in proportion to speed beyond the nominal one: lubricant, seals, back-EMF."""

    extra: float = parameter("N/(m/s)", 60.0, -60.0, 2000.0, "added to the nominal viscous coefficient", on="viscous")
