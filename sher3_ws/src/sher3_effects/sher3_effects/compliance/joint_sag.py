"""A joint of an arm that gives way under what it carries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.view import ArmView


class JointSag(Page):
    """A joint turns on under the weight behind it: by so much a metre that it hangs out from the joint's axis."""

    id, family, stage = "joint_sag", "compliance", "mechanism"
    best = Best("postures", "well-spread postures separate geometric errors")
    kinds, places = ("arm",), ("joint",)
    gives = ("sag",)
    tried = ({"out": 1.0}, {"out": 0.5}, {"out": 0.0})
    """Where the weight is: at the flange (1), in the middle of the links behind the joint (0), or between."""
    leaves_out = "small errors of the other joints"
    explanation = "One joint gives way under the weight behind it: its gear or its bearing is a spring."
    siblings = {
        "encoder_offset": "the same angle in every posture",
        "rail_tilt": "about an axis across the joint's",
    }
    units = {"sag": "rad/m"}
    seen_at = (("", "tip"),)
    SOFTEST = 1.0
    """Turn for each metre, rad, from which no weight does it: a hobby servo of 5 N m/rad gives 1 under 5 N."""
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {"sag": (-SOFTEST, SOFTEST)}

    def signature(self, view: ArmView, site: str, shape: Shape) -> Signature:
        """One column: the turn about the joint's axis that gravity asks for, the base being level, per rad/m."""
        axis, place = view.postures.axes[:, view.row(site)], view.place(site)
        tip, middle = view.carried(site)
        out = middle + shape["out"] * (tip - middle) - place
        lever = np.cross(out, axis)[:, [2]]
        return Signature({self.channels(site)[0]: view.turned(axis * lever, place)[:, :, None]})
