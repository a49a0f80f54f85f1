"""Force scale: the sensor reads too much or too little in proportion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ForceScale(LibraryEffect):
    """reading = (1 + relative) * wrench, of the whole sensor or of one axis."""

    id, family, stage = "force_scale", "scale", "sensing"
    explanation = (
        "The force sensor's reading is off by a constant ratio: nothing without load, more the larger the load."
    )
    siblings = {"force_crosstalk": "a load on one axis shows on another", "force_bias": "does not depend on the load"}
    units = {"relative": "1", "axis": "1"}

    def sites(self) -> tuple[str, ...]:
        """The force sensor."""
        return ("force_sensor",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen in the force sensor's reading."""
        return (Channel("sensing", "force_sensor"),)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Forces and moments (-1), forces only (-2), one component (0..5)."""
        return [{"axis": float(a)} for a in (-1, -2, 0, 1, 2)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the nominal reading of the components concerned."""
        keep = {-1: np.ones(6), -2: np.array([1.0, 1, 1, 0, 0, 0])}.get(int(shape["axis"]))
        if keep is None:
            keep = np.eye(6)[int(shape["axis"])]
        return Signature({Channel("sensing", site): (view.path.nominal_wrench * keep)[:, :, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Ratio error and the axis it is of."""
        return {"relative": float(coefficients[0]), "axis": shape["axis"]}
