"""Payload: mass the model does not know."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_description.contract import GRAVITY
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.inertia.gravity_load import carried_mass
from sher3_effects.page import Page, Tolerated
from sher3_effects.view import ArmMotionView, AxisView, RobotView


class PayloadMass(Page):
    """Mass carried by one axis (inertia and weight), by the platform or at the tip."""

    id, family, stage = "payload_mass", "inertia", "motor_mechanics"
    inputs = ("acceleration", "weight")
    gives = ("mass",)
    scales = "payload"
    best = Best("steps", "accelerations separate mass from weight")
    places: ClassVar[tuple[str, ...]] = ("axis", "tip")
    explanation = "Extra mass: more force in proportion to acceleration, and more weight where the axis carries it."
    siblings = {"gravity_load": "weight without inertia", "torque_constant": "all forces are scaled"}
    bounds = {"mass": (-np.inf, np.inf)}
    """What is added to a stated mass may be less than nothing."""

    def channels(self, site: str) -> tuple[Channel, ...]:
        """A tip mass shows on every axis."""
        return tuple(Channel(self.stage, a) for a in ACTUATORS) if site == "tip" else super().channels(site)

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """What carries the mass: the axis alone, or, for a delta axis, the whole platform."""
        return [{"weight": 1.0}] if site == "tip" else [{"weight": 0.0}, {"weight": 1.0}]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """One column: acceleration plus the weight, per kilogram."""
        if site == "tip":
            weight = GRAVITY * view.path.jacobian[:, 2, :]
            across = view.path.jacobian[:, :3]
            inertia = np.einsum("gji,gjk,gk->gi", across, across, view.acceleration)
            return Signature({c: column(weight[:, i] + inertia[:, i]) for i, c in enumerate(self.channels(site))})
        axis = view.row(site)
        inertia = view.acceleration[:, axis]
        scale = {3: view.robot.arm.roll_mass, 4: view.robot.arm.tilt_mass}.get(axis, view.robot.delta.moving_mass)
        return Signature(
            {Channel(self.stage, site): column(inertia + shape["weight"] * view.path.gravity[:, axis] / scale)}
        )

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the mass of the axis."""
        if site not in ACTUATORS:
            return ()
        limit = robot.tolerances.mass * robot.actuators[ACTUATORS.index(site)].mass
        return (Tolerated({"weight": 0.0}, {f"mass of {site}": (limit, self.unit("mass", site, site == "roll"))}),)

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the mass, coefficients (1,), is above zero; of a shape without weight any is.

        A payload adds mass: where weight is missing, it is the weight that is off; an axis alone may be lighter.
        """
        return not shape["weight"] or bool(coefficients[0] > 0.0)


class MassOnAxis(PayloadMass):
    """Mass on one axis of any machine that its description does not know: F = mass * a.

    An axis without a drive shows ratios of forces only: its mass is the unit of all others, and cannot be told.
    """

    kinds, places = ("axis",), ("axis",)
    plain = True
    needs = ("mass", "drive")
    on_axis = {"mass": "inertia"}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return one shape: it holds the stated mass, kg or kg m^2, which bounds what may be missing."""
        return [{"stated": min(view.axis(site).mass for view in views)}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: the acceleration."""
        return Signature({Channel(self.stage, site): column(view.acceleration[:, view.row(site)])})

    def limits(self, shape: Shape) -> Mapping[str, tuple[float, float]]:
        """Return the bounds of the mass: at most the stated mass may be missing."""
        return {"mass": (-shape["stated"], np.inf)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether a mass is left, the stated one and that of (1,) [kg or kg m^2]: none is below zero."""
        return bool(shape["stated"] + coefficients[0] > 0.0)


class PayloadOnLink(PayloadMass):
    """A body on a link of a serial arm, moving with it: F = mass * (column of its mass) + mass * centre * (columns).

    The rigid bodies' equations are linear in mass and mass times centre; the inertia of the payload is reckoned as that
    of a point at its centre, which is found first and put into the shape.
    """

    kinds, places = ("joint",), ("link",)
    shapes = Page.shapes
    plain = True
    about = ("x", "y", "z")
    on_axis = {"mass": "payload", "x": "payload_x", "y": "payload_y", "z": "payload_z"}
    units = {"mass": "kg", "x": "m", "y": "m", "z": "m"}
    explanation = "A body on a link that the model does not know: weight and inertia on every joint that carries it."
    siblings = {
        "gravity_load": "one joint alone, and no inertia",
        "torque_constant": "all forces of one joint are scaled, those of the other joints are right",
    }
    FURTHEST = 1.0
    """Distance of the centre from the joint of its link, m, from which it is no payload."""

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the link: which joints carry it only the view knows."""
        return (Channel(self.stage, site),)

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return four columns on every joint: per kg, and per kg m along x, y and z of the link's joint."""
        arm: ArmMotionView = view
        forces = arm.payload(site, (shape.get("x", 0.0), shape.get("y", 0.0), shape.get("z", 0.0)))
        return Signature({Channel(self.stage, joint): x[:, None, :] for joint, x in forces.items()})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the mass [kg] and its centre [m], of coefficients (4,): mass, and mass times centre [kg m]."""
        mass = float(coefficients[0])
        centre = coefficients[1:] / mass if mass else np.zeros(3)
        return {"mass": mass, **{name: float(c) for name, c in zip("xyz", centre, strict=True)}}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether coefficients (4,) [kg, kg m] add mass, near the link that carries it."""
        mass = float(coefficients[0])
        return mass > 0.0 and bool(np.linalg.norm(coefficients[1:]) < self.FURTHEST * mass)


@dataclass(frozen=True)
class PayloadMassInPlant(PlantEffect, page=PayloadMass, sites=(*ACTUATORS, "all")):
    """More mass to accelerate on an axis than the model has; on a slider, whose rail is vertical, also more weight."""

    mass: float = parameter("kg", 0.5, -5.0, 20.0, "added to the axis")

    def apply(self, p: PlantParameters) -> None:
        """Add inertia, and on the sliders the weight of the same mass on the platform."""
        for row in self.rows:
            p.axis["mass"][row] += self.mass if row != 3 or self.actuator == "roll" else self.mass / 500
            if row < 3:
                p.axis["gravity_scale"][row] += self.mass / carried_mass(p.robot, row)
