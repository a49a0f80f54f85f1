"""Tilt linkage: a member of the slider-crank differs from the drawing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class TiltLinkageError(LibraryEffect):
    """Crank, coupler or offset of the tilt linkage is off by `length`."""

    id, family, stage = "tilt_linkage_error", "geometry", "mechanism"
    explanation = (
        "The tilt angle is not the one its slider should give: the tip turns too far or not far enough, by an "
        "amount that depends on the tilt."
    )
    siblings = {
        "encoder_offset": "a constant slider error",
        "encoder_scale": "the load encoder disagrees with the motor's",
    }
    units = {"length": "m", "member": "1"}
    MEMBERS = ("crank", "coupler", "offset")

    def sites(self) -> tuple[str, ...]:
        """The tilt axis."""
        return ("tilt",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Which member (0 crank, 1 coupler, 2 offset), and where the slider's zero is.

        With `drawn_zero` 0 the axis was homed at zero tilt of the linkage as built, with 1 where the drawing has it.
        """
        return [{"member": float(i), "drawn_zero": z} for i in range(len(self.MEMBERS)) for z in (0.0, 1.0)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the change of the pose per metre."""
        member = self.MEMBERS[int(shape["member"])]
        p = view.geometry.parameters
        reach = np.sqrt(p.coupler**2 - (p.offset - p.crank) ** 2)
        slope = {"crank": p.offset - p.crank, "coupler": p.coupler, "offset": p.crank - p.offset}[member] / reach
        change = view.geometry.pose_change(view.run, 1e-5, **{member: 1.0, "zero_5": -shape["drawn_zero"] * slope})
        return Signature(view.at_tip(change[:, :, None]))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Length error and the member it is of."""
        return {"length": float(coefficients[0]), **shape}
