"""Cable drag: a pull that depends on the pose and lags behind the motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_description import ACTUATORS

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class CableDrag(LibraryEffect):
    """On an axis: k q + k0 + hysteresis over a long stroke; on the force sensor: the same of roll and tilt (as
    angles), per component.
    """

    id, family, stage = "cable_drag", "wrench", "motor_mechanics"
    extends = ("gravity_load", "presliding_friction")
    explanation = (
        "A cable or tube pulls: the force changes smoothly with the pose and differs a little between the two "
        "directions."
    )
    siblings = {
        "gravity_load": "in proportion to weight",
        "presliding_friction": "saturates within a short stroke",
        "tool_gravity": "turns with the tool exactly as weight does",
    }
    units = {"stiffness": "N/m", "force": "N", "preload": "N"}

    def sites(self) -> tuple[str, ...]:
        """Any axis, or the force sensor."""
        return (*ACTUATORS, "force_sensor")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """On the force sensor it is a matter of sensing."""
        return (Channel("sensing", site),) if site == "force_sensor" else super().channels(site)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Stroke over which the hysteresis turns, in motor revolutions (0: none)."""
        return [{"stroke": 0.0}, {"stroke": 0.25}, {"stroke": 1.0}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Offset, stiffness and, with a stroke, hysteresis."""
        if site == "force_sensor":
            return self._sensor(view, shape)
        axis = axis_of(site)
        q = view.position[:, axis]
        parts = [np.ones_like(q), q]
        if shape["stroke"]:
            parts.append(view.run.to_grid(view.sliding(axis, shape["stroke"] * lead(view, site))))
        return Signature({Channel(self.stage, site): column(*parts)})

    def _sensor(self, view: View, shape: Shape) -> Signature:
        radius = view.robot.tilt_linkage.crank
        drives = [view.position[:, 3], view.position[:, 4] / radius]
        if shape["stroke"]:
            drives += [
                view.run.to_grid(view.sliding(axis, shape["stroke"] * view.robot.actuators[axis].lead))
                for axis in (3, 4)
            ]
        columns = np.zeros((len(drives[0]), 6, 3 * len(drives)))
        for j, drive in enumerate(drives):
            columns[:, [0, 1, 2], [3 * j, 3 * j + 1, 3 * j + 2]] = drive[:, None]
        return Signature({Channel("sensing", "force_sensor"): columns})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Stiffness and force of the hysteresis; the largest component, in N per rad, on the force sensor."""
        if len(coefficients) > 3:
            out = {"stiffness": float(np.abs(coefficients[:6]).max())}
            return out if len(coefficients) == 6 else {**out, "force": float(np.abs(coefficients[6:]).max())}
        out = {"preload": float(coefficients[0]), "stiffness": float(coefficients[1])}
        return out if len(coefficients) == 2 else {**out, "force": float(coefficients[2])}

    def unit(self, name: str, site: str) -> str:
        """A stiffness is per angle on the force sensor."""
        return "N/rad" if site == "force_sensor" and name == "stiffness" else super().unit(name, site)
