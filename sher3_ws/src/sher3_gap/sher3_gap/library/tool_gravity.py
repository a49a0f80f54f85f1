"""Tool gravity: the tool weighs more or less than the model says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ToolGravity(LibraryEffect):
    """reading += mass * g turned into {f}, at the centre of mass (and its shift)."""

    id, family, stage = "tool_gravity", "wrench", "sensing"
    explanation = (
        "What the sensor reads of the tool's weight is off: the error turns with roll and tilt exactly as gravity does."
    )
    siblings = {"force_bias": "does not turn", "cable_drag": "turns, but lags behind the motion"}
    units = {"mass": "kg", "com_x": "kg*m", "com_y": "kg*m", "com_z": "kg*m"}

    def sites(self) -> tuple[str, ...]:
        """The force sensor."""
        return ("force_sensor",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen in the force sensor's reading."""
        return (Channel("sensing", "force_sensor"),)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """At the nominal centre of mass, or with a first moment of its own."""
        return [{"free_com": 0.0}, {"free_com": 1.0}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Weight per kilogram; with a free centre also the first moment."""
        unit = view.path.tool_wrench / view.robot.force_sensor.tool_mass
        if not shape["free_com"]:
            return Signature({Channel("sensing", site): unit[:, :, None]})
        columns = np.zeros((len(unit), 6, 4))
        columns[:, :3, 0] = unit[:, :3]
        for a in range(3):
            columns[:, 3:, 1 + a] = np.cross(np.eye(3)[a], unit[:, :3])
        return Signature({Channel("sensing", site): columns})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Extra mass; with a free centre the extra first moment."""
        names = ("mass", "com_x", "com_y", "com_z")[: len(coefficients)]
        return {n: float(c) for n, c in zip(names, coefficients, strict=True)}
