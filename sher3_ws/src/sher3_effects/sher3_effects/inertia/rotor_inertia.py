"""Rotor inertia: what the motor's own rotor adds to a joint."""

from __future__ import annotations

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class RotorInertia(Page):
    """Inertia of the rotor, seen through the gear, that the model of an arm does not have: F = inertia * a."""

    id, family, stage = "rotor_inertia", "inertia", "motor_mechanics"
    inputs = ("acceleration",)
    above = 0.0
    kinds = ("joint",)
    plain = True
    shown_by = ("lost_motion", "compliance")  # a rotor that moves otherwise than its link is told from it
    best = Best("steps", "accelerations separate mass from weight")
    explanation = (
        "The motor's own rotor must be accelerated, gear ratio squared: force by acceleration, whatever the posture."
    )
    siblings = {
        "payload_mass": "weight as well, and forces on the other joints",
        "viscous_friction": "follows the speed",
    }
    gives = ("inertia",)
    units = {"inertia": "kg"}
    on_axis = {"inertia": "inertia"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: the acceleration."""
        return Signature({Channel(self.stage, site): column(view.acceleration[:, view.row(site)])})
