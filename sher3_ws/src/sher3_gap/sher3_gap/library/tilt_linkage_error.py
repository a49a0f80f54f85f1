"""Tilt linkage: a member of the slider-crank differs from the drawing."""

from __future__ import annotations

from collections.abc import Sequence

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
        """Which member: 0 crank, 1 coupler, 2 offset."""
        return [{"member": float(i)} for i in range(len(self.MEMBERS))]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the change of the pose per metre."""
        change = view.geometry.pose_change(view.run, 1e-5, **{self.MEMBERS[int(shape["member"])]: 1.0})
        return Signature(view.at_tip(change[:, :, None]))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Length error and the member it is of."""
        return {"length": float(coefficients[0]), "member": shape["member"]}
