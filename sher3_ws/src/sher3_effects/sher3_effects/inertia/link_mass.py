"""Link mass: a link of an arm that is heavier or lighter than its model says."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.view import ArmMotionView


class LinkMass(Page):
    """All inertial parameters of a link are off by one share: F = share * (force that the modelled link needs).

    A link whose mass was typed in wrongly, or computed from a wrong density, keeps its centre and its shape.
    """

    id, family, stage = "link_mass", "inertia", "motor_mechanics"
    inputs = ("acceleration", "weight")
    scales = "payload"
    kinds, places = ("joint",), ("link",)
    plain = True
    best = Best("steps", "accelerations separate mass from weight")
    explanation = (
        "A link is heavier or lighter than its model says: its weight and inertia, on every joint that carries it."
    )
    siblings = {
        "payload_mass": "only heavier, with a centre of its own",
        "torque_constant": "all forces of one joint are scaled, those of the other joints are right",
        "rotor_inertia": "one joint alone, and no weight",
    }
    gives = ("relative",)
    units = {"relative": "1"}
    on_axis = {"relative": "link"}
    bounds: ClassVar[dict[str, tuple[float, float]]] = {"relative": (-1.0, np.inf)}
    above = -1.0

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return one column on every joint that carries the link: the force that the link as modelled needs."""
        arm: ArmMotionView = view
        return Signature({Channel(self.stage, joint): x[:, None, None] for joint, x in arm.link(site).items()})
