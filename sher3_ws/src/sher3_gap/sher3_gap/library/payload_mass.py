"""Payload: mass the model does not know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_kinematics.kernel import GRAVITY

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class PayloadMass(LibraryEffect):
    """Mass carried by one axis (inertia and weight), by the platform or at the tip."""

    id, family, stage = "payload_mass", "inertia", "motor_mechanics"
    explanation = "Extra mass: more force in proportion to acceleration, and more weight where the axis carries it."
    siblings = {"gravity_load": "weight without inertia", "torque_constant": "all forces are scaled"}
    units = {"mass": "kg"}

    def sites(self) -> tuple[str, ...]:
        """Any axis, or the tip."""
        return (*super().sites(), "tip")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """A tip mass shows on every axis."""
        return (
            tuple(Channel(self.stage, a) for a in LibraryEffect.sites(self))
            if site == "tip"
            else super().channels(site)
        )

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """What carries the mass: the axis alone, or, for a delta axis, the whole platform."""
        return [{"weight": 1.0}] if site == "tip" else [{"weight": 0.0}, {"weight": 1.0}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: acceleration plus the weight, per kilogram."""
        if site == "tip":
            weight = GRAVITY * view.path.jacobian[:, 2, :]
            acceleration = view.run.to_grid(view.run.acceleration)
            inertia = np.einsum("gji,gjk,gk->gi", view.path.jacobian[:, :3], view.path.jacobian[:, :3], acceleration)
            return Signature({c: column(weight[:, i] + inertia[:, i]) for i, c in enumerate(self.channels(site))})
        axis = axis_of(site)
        inertia = view.run.to_grid(view.run.acceleration[:, axis])
        scale = {3: view.robot.arm.roll_mass, 4: view.robot.arm.tilt_mass}.get(axis, view.robot.delta.moving_mass)
        return Signature(
            {Channel(self.stage, site): column(inertia + shape["weight"] * view.path.gravity[:, axis] / scale)}
        )

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Extra mass (inertia on roll)."""
        return {"mass": float(coefficients[0])}

    def unlikely(self, shape: Shape, coefficients: Array) -> bool:
        """A payload adds mass; where some is missing it is the weight that is off."""
        return bool(coefficients[0] < 0.0)

    def unit(self, name: str, site: str) -> str:
        """Inertia on the rotary axis."""
        return "kg*m^2" if site == "roll" else "kg"
