"""Joint clearance: a ball joint of a leg rattles, or the joint between the tilt slider and its four-bar."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description.contract import GRAVITY
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.kernel.tip import CONTACT_FORCE
from sher3_sim.parameters import PlantParameters

from sher3_effects.operators import play
from sher3_effects.page import TIP_POSE, Page
from sher3_effects.view import RobotView

REST_FORCE = 0.2
"""Force at which a ball joint rests on one side of its clearance, N."""


class JointClearance(Page):
    """What a slider moves is ahead of it or behind by clearance / 2, by its direction or by the sign of its load.

    Where the load decides, a leg is that much longer or shorter; where the direction does, it follows its slider late.
    """

    id, family, stage = "joint_clearance", "lost_motion", "mechanism"
    inputs = ("direction", "load", "posture")
    seen_at = TIP_POSE
    best = Best("loads", "known loads at rest separate a fixed gap from a spring")
    leaves_out = "the elasticity of its contact"
    places = ("leg", "tilt")
    discrete = frozenset({"by_load"})
    explanation = (
        "A joint has play: the tip jumps by a fixed amount when the load or the direction of the leg, or of the tilt "
        "slider, reverses, with no trace in the encoders."
    )
    siblings = {
        "backlash": "the load encoder lags behind the motor's",
        "structural_compliance": "in proportion to the load",
    }
    REACHES = (2.5e-3, 5e-3, 1e-2, 2e-2, 4e-2, 8e-2, 0.16)
    """Stroke over which the side changes with the direction, in motor revolutions: a rigid gap is crossed by as much
    travel as it is wide."""
    finer = {"reach": (0.84, 1.19)}
    WIDEST = 2.0
    """Jump over the travel that crosses the gap beyond which it is no gap: a rigid one has 1, a soft one less."""

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """What decides the side: 0 the direction of the slider, 1 the force on it, 2 that on each link of the leg.

        A side that never changes makes no shape: it cannot be seen.
        """
        lead = views[0].lead(site)
        shapes: list[Shape] = [*({"by_load": 0.0, "reach": r * lead} for r in self.REACHES)]
        shapes += [{"by_load": 1.0, "reach": 0.0}]
        shapes += [{"by_load": 2.0, "reach": 0.0}] if site != "tilt" else []
        return [
            s for s in shapes if np.ptp(np.concatenate([self._side(v, site, s) for v in views]), axis=0).max() > 1.0
        ]

    def _side(self, view: RobotView, site: str, shape: Shape) -> Array:
        """Side on which each link of the leg, or twice the tilt slider, rests, (g, 2) in -1..1."""
        axis = view.row(site)
        if shape["by_load"] == 2.0:
            return np.tanh(link_forces(view)[:, 2 * axis : 2 * axis + 2] / REST_FORCE)
        if shape["by_load"]:
            force = view.path.contact_force[:, axis] - view.path.gravity[:, axis]
            return np.repeat(np.tanh(force / CONTACT_FORCE)[:, None], 2, axis=1)
        x, width = view.run.smooth[:, axis], shape["reach"]
        side = -2.0 / width * play(x, width)[view.run.grid]
        return np.repeat(side[:, None], 2, axis=1)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Half the change of the pose per metre of either link, or of the slider, with the sign of the side."""
        if site == "tilt" or not shape["by_load"]:
            change = view.path.jacobian[:, :, [view.row(site)]] * self._side(view, site, shape)[:, None, :1]
            return Signature(view.at_tip(0.5 * change))
        first = 2 * view.row(site)
        change = view.link_changes[:, :, first : first + 2] * self._side(view, site, shape)[:, None, :]
        return Signature(view.at_tip(0.5 * change))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the clearance: where direction decides, the travel that crosses it; else the mean size of (p,)."""
        if shape["by_load"]:
            return {"clearance": float(np.abs(coefficients).mean())}
        return {"clearance": shape["reach"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether what has play lags its slider, by the first of (p,), no more than a gap of that width lets."""
        if shape["by_load"]:
            return True
        return bool(-self.WIDEST * shape["reach"] <= coefficients[0] <= 0.0)


def link_forces(view: RobotView) -> Array:
    """Forces of the six links under the platform's weight and the known contact, (g, 6): Gamma f = w."""
    weight = np.array([0.0, 0.0, -GRAVITY * view.robot.delta.moving_mass])
    wrench = np.hstack([view.path.contact + weight, np.cross(view.lever, view.path.contact)])
    return np.linalg.solve(view.links, wrench[:, :, None])[:, :, 0]


@dataclass(frozen=True)
class JointClearanceInPlant(PlantEffect, page=JointClearance):
    """Joints have play: a leg is longer under tension than under compression by the clearance, and the four-bar follows
    the tilt slider on one side or the other of it.
    """

    clearance: float = parameter("m", 10e-6, 0.0, 1e-3, "travel between tension and compression")

    def apply(self, p: PlantParameters) -> None:
        """Give the leg or the slider play."""
        p.axis["clearance"][self.rows] += self.clearance
        p.body["gives_way"] = True
