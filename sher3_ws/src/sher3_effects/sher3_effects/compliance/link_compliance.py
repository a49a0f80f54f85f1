"""Link compliance: the links of the delta give way, more at small forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_description.contract import GRAVITY
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import SLIDERS, PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page, Part, Values
from sher3_effects.view import RobotView


class LinkCompliance(Page):
    """Each link shortens by a |F|^b under the load on the tip, alone or with the weight of the platform."""

    id, family, stage = "link_compliance", "compliance", "structure"
    inputs = ("load", "posture")
    seen_at = (("structure", "tip"), ("mechanism", "tip"))
    above = 0.0
    best = Best("loads", "known loads in several postures separate springs")
    places = ("tip", "leg")
    gives = ("a", "own_weight")
    units = {"a": "m/N^b", "own_weight": "1"}
    discrete = frozenset({"own_weight"})
    tried = ({"own_weight": 0.0}, {"own_weight": 1.0})
    """Whether the links carry the weight of the platform (1) or that is calibrated away (0)."""
    explanation = (
        "The six links of the delta and their joints give way under the load on the tip, relatively more at "
        "small forces than at large ones."
    )
    siblings = {"structural_compliance": "in proportion to the force"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """One column: the deflection of the tip by the paper's law."""
        if view.run.tracker_position is None:
            return Signature()
        legs = (0, 1, 2) if site == "tip" else (int(site[-1]) - 1,)
        out = link_deflection(view, legs, bool(shape["own_weight"]))[:, :, None]
        return Signature(view.at_tip(out) if shape["own_weight"] else {Channel("structure", "tip"): out})

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the coefficient as a fraction of the paper's law with pre-loading springs."""
        delta = robot.delta
        fraction = values["a"] / (delta.spring_factor * delta.link_compliance.a)
        return [Part(self.id, actuator, {"fraction": fraction, "own_weight": values["own_weight"]})]


def link_deflection(view: RobotView, legs: Sequence[int], own_weight: bool) -> Array:
    """Deflection of the tip (g, 6) per coefficient a of the law, from the compliance of the links of `legs` under the
    known contact force, with the platform's weight or without.

    Link forces f = Gamma^-1 w, deflections by the paper's law, tip displaced as by links of other lengths.
    """
    delta = view.robot.delta
    force = view.path.contact
    wrench = np.hstack([force, np.cross(view.lever, force)])
    wrench[:, 2] -= GRAVITY * delta.moving_mass * own_weight
    link = np.linalg.solve(view.links, wrench[:, :, None])[:, :, 0]
    law = delta.link_compliance
    change = np.sign(link) * np.abs(link) ** law.b
    keep = np.repeat([k in legs for k in range(3)], 2)
    return np.einsum("gij,gj->gi", view.link_changes, change * keep)


@dataclass(frozen=True)
class LinkComplianceInPlant(PlantEffect, page=LinkCompliance, sites=(*SLIDERS, "all", "tip")):
    """The links of the delta stage, of a leg or of all, give way as a |F|^b: a fraction of the paper's measured law."""

    fraction: float = parameter("1", 0.5, 0.0, 10.0, "of the paper's link law with springs")
    own_weight: float = parameter("1", 0.0, 0.0, 1.0, "whether the links carry the platform's weight")

    def apply(self, p: PlantParameters) -> None:
        """Soften the links."""
        rows = self.rows if self.actuator in SLIDERS else [0, 1, 2]
        p.body["link_fraction"][0, rows] += self.fraction
        p.body["link_weight"] = GRAVITY * p.robot.delta.moving_mass * round(self.own_weight)
        p.body["gives_way"] = True
