"""Gravity load: weight on an axis that differs from the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_kinematics.kernel import gravity_load_into, kernel_parameters
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.compliance.two_slopes import BENT_FROM
from sher3_effects.page import Page, Part, Tolerated, Values
from sher3_effects.view import AxisView


class GravityLoad(Page):
    """Extra gravity force on an axis: in proportion to the modelled one, or constant."""

    id, family, stage = "gravity_load", "inertia", "motor_mechanics"
    inputs = ("weight",)
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    scales = "weight"
    best = Best("steps", "accelerations separate mass from weight")
    explanation = "The axis holds more or less weight than the model says, at rest and in motion, without more inertia."
    siblings = {
        "payload_mass": "inertia as well as weight",
        "torque_constant": "all forces are scaled",
        "cable_drag": "the force changes with pose and direction",
    }
    units = {"relative": "1", "force": "N"}
    on_axis = {"force": "offset", "relative": "weight"}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return scaled (0) and constant (1); only constant where the model has no weight to scale."""
        scaled: list[Shape] = [{"constant": 0.0}] if any(v.path.gravity.any() for v in views) else []
        return [*scaled, {"constant": 1.0}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: the modelled gravity force, or ones."""
        gravity = view.path.gravity[:, view.row(site)]
        return Signature({Channel(self.stage, site): column(np.ones_like(gravity) if shape["constant"] else gravity)})

    def scales_model(self, shape: Shape) -> bool:
        """Return whether it is a share of the modelled weight."""
        return not shape["constant"]

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the weight that the axis carries."""
        return (Tolerated({"constant": 0.0}, {f"gravity load of {site}": (robot.tolerances.gravity_load, "1")}),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return coefficients (1,) as the ratio of the extra weight to the modelled one, or as the extra force."""
        return {"force" if shape["constant"] else "relative": float(coefficients[0])}

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the mass whose weight is missing: a share of the carried one, or a force at zero of all axes."""
        row = ACTUATORS.index(actuator)
        carried = carried_mass(robot, row)
        if "relative" in values:
            return [Part(self.id, actuator, {"mass": values["relative"] * carried})]
        weight = np.zeros(5)
        gravity_load_into(kernel_parameters(robot), np.zeros(5), weight)
        hangs = abs(weight[row]) >= 1e-6  # N: an axis that carries no weight at zero cannot carry a share of it
        return [Part(self.id, actuator, {"mass": values["force"] / weight[row] * carried if hangs else 0.0})]


class GravityOnAxis(GravityLoad):
    """The same on one axis of any machine; on an axis that turns it may be a weight at an arm: a sin q + b cos q.

    A constant force beside it, such as that of a cable or of a zero that is off, is a bend.
    """

    kinds = ("axis",)
    plain = True
    parted_by_travel = BENT_FROM
    units = {"relative": "1", "force": "N", "arm": "N", "hanging": "m"}
    on_axis = {"force": "offset", "relative": "weight", "arm": "arm", "hanging": "hanging"}
    TRAVEL = 0.3
    """Travel, rad, from which a weight at an arm differs from a constant force."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the shapes of every machine, and a weight at an arm (2) where the description has none."""
        found = super().shapes(views, site)
        axes = [v.axis(site) for v in views]
        swings = all(a.weighed for a in axes) and max(a.travel for a in axes) > self.TRAVEL
        return [*found, {"constant": 2.0}] if swings else found

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return a weight at an arm and a constant force."""
        return [{**shape, "constant": 3.0}] if shape["constant"] == 2.0 else []

    def plainer(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the shapes of fewer numbers: over part of a turn a weight and the force beside it change places."""
        least = shape["constant"] if shape["constant"] >= 2.0 else 0.0
        return [s for s in self.shapes(views, site) if s["constant"] < least]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column; for a weight at an arm sine and cosine of the position, and ones for a force beside it.

        They are filtered as forces are: the sine of a filtered angle is not the filtered sine.
        """
        if shape["constant"] < 2.0:
            return super().signature(view, site, shape)
        q = view.run.motor[:, view.row(site)]
        arm = view.run.to_grid(np.column_stack([np.sin(q), np.cos(q)]))
        beside = [np.ones(len(arm))] if shape["constant"] == 3.0 else []
        return Signature({Channel(self.stage, site): column(*arm.T, *beside)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the largest weight, the position at which the axis hangs down, and a force beside it.

        Coefficients: (1,) as of `GravityLoad`; else those of sine and cosine (2,), with a force beside them (3,).
        """
        if shape["constant"] < 2.0:
            return super().parameters(shape, coefficients)
        sine, cosine, *beside = map(float, coefficients)
        weight = {"arm": float(np.hypot(sine, cosine)), "hanging": float(np.arctan2(-cosine, sine))}
        return {**weight, **({"force": beside[0]} if beside else {})}


class ServoSag(GravityOnAxis):
    """A position servo that hangs behind its reference under a weight: the load over the servo's stiffness."""

    kinds = ("servo",)
    needs = ("held",)
    indistinct = ("encoder_offset",)
    explanation = "The axis rests beside its reference, as a spring does under a weight."
    siblings = {
        "coulomb_friction": "the side it rests on changes with the direction it came from",
        "encoder_offset": "a sag grows with the load, a zero does not",
    }
    units = {"force": "m", "relative": "m/N", "arm": "m", "hanging": "m"}
    STILL, LONG, RESTING, TOLD = 0.05, 1 / 40, 0.6, 0.2
    """Share of the top speed below which a servo rests, and of a record for how long; the share of it that it rests at
    most without the rests having to tell its sag; the least singular value over the largest one from which they do,
    that of two rests 0.3 rad apart.
    """

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the shapes of an axis that the rests of the servo tell."""
        return [shape for shape in super().shapes(views, site) if self.sag_observable(views, site, shape)]

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return a weight at an arm and a constant force, where rests tell them."""
        return [bent for bent in super().bends(views, site, shape) if self.sag_observable(views, site, bent)]

    def sag_observable(self, views: Sequence[AxisView], site: str, shape: Shape) -> bool:
        """Return whether the places at which a servo rests tell its sag, where it rests most of the time.

        A weight at an arm does nothing at 0 and at 180 degrees: the way between them is no witness of it.
        """
        if shape["constant"] < 2.0:
            return True
        speeds = [np.abs(view.run.velocity[:, view.row(site)]) for view in views]
        spans = [np.ones(int(self.LONG * len(speed)) + 1) for speed in speeds]
        moving = [np.convolve(x >= self.STILL * x.max(), span, "same") for x, span in zip(speeds, spans, strict=True)]
        still = np.concatenate(moving) < 0.5
        q = np.concatenate([view.run.motor[:, view.row(site)] for view in views])[still]
        if len(q) < self.RESTING * len(still):
            return True
        arm = np.column_stack([np.sin(q), np.cos(q), *([np.ones(len(q))] if shape["constant"] == 3.0 else [])])
        sizes = np.linalg.svd(arm, compute_uv=False)
        return bool(sizes[-1] > self.TOLD * sizes[0])


@dataclass(frozen=True)
class GravityLoadInPlant(PlantEffect, page=GravityLoad, sites=(*ACTUATORS, "all")):
    """More weight on an axis than the model has, without inertia worth speaking of: a wrong mass, a lost spring."""

    mass: float = parameter(
        "kg", 0.2, -2.0, 10.0, "whose weight is added where the axis carries its own", fixed_unit=True
    )

    def apply(self, p: PlantParameters) -> None:
        """Scale the axis's own gravity."""
        for row in self.rows:
            p.axis["gravity_scale"][row] += self.mass / carried_mass(p.robot, row)


def carried_mass(robot: Robot, row: int) -> float:
    """Return the nominal mass (kg) whose weight an axis carries."""
    arm = robot.arm
    return (robot.delta.moving_mass if row < 3 else arm.tilt_mass + (arm.roll_mass if row == 3 else 0.0)) or 1.0
