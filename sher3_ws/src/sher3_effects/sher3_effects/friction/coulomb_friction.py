"""Coulomb friction: a force of constant size against the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, rub
from sher3_effects.friction.dry import DryFriction
from sher3_effects.operators import held_lag, play
from sher3_effects.page import Tolerated
from sher3_effects.view import AxisView


class CoulombFriction(DryFriction):
    """F = force * z, z the Dahl state over a displacement of a few micrometres."""

    id, family, stage = "coulomb_friction", "friction", "motor_mechanics"
    inputs = ("direction",)
    gives = ("force", "displacement")
    above = 0.0
    dry = True
    settles = True
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    leaves_out = "how its level varies over the stroke"
    explanation = (
        "The axis needs a constant extra force whose sign follows the direction of motion: a step at every "
        "reversal, the same "
        "at every speed."
    )
    siblings = {
        "presliding_friction": "the force builds up over tens of micrometres instead of a few",
        "stribeck_friction": "the force is higher at low speed",
        "viscous_friction": "the force grows with speed",
    }
    on_axis = {"force": "coulomb"}
    finer = {"displacement": (0.4,)}
    DISPLACEMENTS: ClassVar[tuple[float, ...]] = (1.0e-3, 2.5e-3, 5.0e-3)
    """In motor revolutions: 2, 5 and 10 um on a 2 mm lead."""

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the friction of the axis beyond its nominal friction."""
        axis = robot.actuators[ACTUATORS.index(site)]
        limit, unit = robot.tolerances.friction * axis.drive.rated, self.unit("force", site, site == "roll")
        return (Tolerated({"displacement": self.DISPLACEMENTS[1] * axis.lead}, {f"friction of {site}": (limit, unit)}),)


class CoulombOnAxis(CoulombFriction):
    """The same on one axis of any machine; its displacement before sliding is not searched more finely."""

    kinds = ("axis",)
    plain = True
    finer = {}
    polished = ("displacement",)
    DISPLACEMENTS = (1.0e-4, 3.0e-4, 1.0e-3, 2.5e-3, 5.0e-3)
    """In motor revolutions, or shares of what stands for one: too long a one reverses the force too late."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return those displacements, m or rad, and one count, and 0: a force that builds up slower turns too late."""
        count = min(view.axis(site).seen for view in views)
        found = super().shapes(views, site)
        counted = [{"displacement": count}] if 0.0 < count < found[0]["displacement"] else []
        return [{"displacement": 0.0}, *counted, *found]


class ServoStiction(CoulombFriction):
    """Coulomb friction under a proportional servo: the axis stays until the error reaches friction over stiffness.

    The position is the reference after a play of +-force, force in units of the servo's stiffness (m or rad of error).
    """

    kinds = ("servo",)
    needs = ("held",)
    plain = True
    indistinct = ("command_deadband",)
    explanation = (
        "The axis does not answer small changes of its reference: it stays until the error is large enough to break it "
        "loose."
    )
    siblings = {
        "drive_lag": "late at every amplitude",
        "command_deadband": "friction grows with the load, a band does not",
    }
    units = {"force": "m", "late": "s", "displacement": "m"}
    SHARES = (0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.45)
    """Half widths of the play that are tried, as shares of the span of the tracking error."""
    LATE = (0.0, 2.0, 4.0)
    """Lag of what the friction sees, in periods of the record: a servo is late before it sticks."""
    REACHES = (1e-3, 5e-3)
    """Displacements, as shares of the travel, over which the error of a servo with a mass turns its sign."""
    MOVES = 0.45
    """Share of the reference's stroke that stiction may hold: an axis that never breaks loose tells nothing of it."""
    finer = {"force": (0.7, 0.85, 0.93, 1.07, 1.15, 1.3), "late": (0.6, 0.8, 1.25, 1.6)}
    polished = ("displacement",)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return half widths of the play, m or rad, and lags, s."""
        i = views[0].row(site)
        pairs = [(v.run.reference[:, i], v.run.motor[:, i]) for v in views if v.run.reference is not None]
        span = float(np.ptp(np.percentile(np.concatenate([r - q for r, q in pairs]), [0.5, 99.5])))
        late = [n * views[0].run.period for n in self.LATE]
        played: list[Shape] = [{"force": s * span, "late": t} for s in self.SHARES for t in late if span]
        return [*(x for x in played if self.allowed(views, site, x)), *self.plain_shapes(views, site)]

    def allowed(self, views: Sequence[AxisView], site: str, shape: Shape) -> bool:
        """Return whether the reference breaks the axis loose; held throughout, its error is the reference itself."""
        i = views[0].row(site)
        stroke = max(float(np.ptp(v.run.reference[:, i])) for v in views if v.run.reference is not None)
        return "displacement" in shape or shape["force"] < self.MOVES * stroke

    def plain_shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return displacements, m or rad, over which the error turns its sign: a force beside the others."""
        travel = max(v.axis(site).travel for v in views)
        return [{"displacement": r * travel} for r in self.REACHES if travel]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return minus the play of the lagged reference; nothing is left to fit."""
        assert view.run.reference is not None
        if "displacement" in shape:
            return super().signature(view, site, shape)
        x = view.run.reference[:, [view.row(site)]]
        x = (held_lag(x, shape["late"], view.run.period) if shape["late"] else x)[:, 0]
        behind = play(x, 2.0 * shape["force"])
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(-behind)[:, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return friction over stiffness, and how late the servo is before it sticks [s]; of the shape, or of (1,)."""
        if "displacement" in shape:
            return super().parameters(shape, coefficients)
        return {"force": shape["force"], **({"late": shape["late"]} if shape["late"] else {})}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether friction (1,) resists; a play of positive width, (0,), always does."""
        return "displacement" not in shape or super().admissible(shape, coefficients)


@dataclass(frozen=True)
class CoulombFrictionInPlant(PlantEffect, page=CoulombFriction):
    """A constant force against motion; at rest it holds up to that force, over a few micrometres of deflection."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in sliding")
    displacement: float = deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise the sliding and static level alike."""
        rub(p, self.rows, self.force, self.displacement)
