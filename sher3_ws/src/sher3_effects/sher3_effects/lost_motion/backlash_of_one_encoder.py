"""Backlash that one encoder alone sees: by the effort of the motor in the gap, or by what a command does not move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_diagnosis.words import rounded

from sher3_effects.behind_motor import BehindMotor
from sher3_effects.friction.coulomb_friction import ServoStiction
from sher3_effects.lost_motion.backlash import Backlash
from sher3_effects.operators import flight, play, second_difference
from sher3_effects.page import Hidden, Page
from sher3_effects.view import AxisView


class BacklashBehindMotor(BehindMotor):
    """effort = mass a + load_mass (a_load - a) + friction of the load where it moves; the load behind a gap of `width`.

    Where the motor crosses the gap it carries neither the load's mass nor its friction; where the far flank takes the
    load along, it carries the blow. The load rests in the gap, or flies on and is braked by its own friction.
    """

    id, family, stage = Backlash.id, Backlash.family, Backlash.stage
    inputs = ("acceleration", "direction")
    best = Best("reversals", "quick reversals of a heavy load show the travel without it")
    on_axis = Backlash.on_axis
    leaves_out = "the elasticity of its contact"
    explanation = "After a reversal the motor moves for a fixed travel without the mass and the friction of its load."
    siblings = {
        "transmission_compliance": "the load rings at one frequency, whatever the amplitude",
        "presliding_friction": "the force builds up over a travel, without a blow at its end",
    }
    units: ClassVar[Mapping[str, str]] = {"width": "m", "load_mass": "kg", "load_friction": "N"}
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {"load_mass": (0.0, np.inf)}
    WIDTHS = tuple(np.geomspace(3e-4, 0.1, 12))
    """In shares of the travel."""
    COUNTS = 4.0
    """Smallest width of a gap, in counts or standard deviations of the encoder's noise."""
    BRAKING = (0.05, 0.2, 0.6, 1.5)
    """What brakes a load that flies across the gap, over the rms acceleration of the motor."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "width": (0.7, 0.8, 0.87, 0.93, 0.97, 1.03, 1.07, 1.15, 1.25, 1.4),
        "braking": (0.5, 0.7, 1.4, 2.0),
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return widths, m or rad, of a load that rests in the gap and of one that flies across it."""
        known = views[0].axis(site)
        if not self.weighs(views, site):
            return []
        square = [np.mean(np.gradient(v.run.velocity[:, v.row(site)], v.run.period) ** 2) for v in views]
        usual, travel = float(np.sqrt(np.mean(square))), max(v.axis(site).travel for v in views)
        widths = [w * travel for w in self.WIDTHS if w * travel > self.COUNTS * known.seen]
        resting: list[Shape] = [{"width": w} for w in widths]
        return [*resting, *({**x, "braking": b * usual} for x in resting for b in self.BRAKING if usual)]

    def least_shown(self, views: Sequence[AxisView], site: str, hidden: Hidden) -> str:
        """Return the smallest play of a load that rests in its gap."""
        widths = sorted(s["width"] for s in self.shapes(views, site) if "braking" not in s)
        least = next((w for w in widths if hidden.shows({"width": w})), None)
        return f"play above {rounded(least, hidden.units[0])} would show" if least else "no play would show"

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return what the load's mass adds, and for one that rests in the gap what its friction adds."""
        run, path = view.run, np.ascontiguousarray(view.run.smooth[:, view.row(site)])
        if "braking" in shape:
            lag = flight(path, shape["width"], shape["braking"], run.period, 0.0)
        else:
            lag = play(path, shape["width"])
        crossing = np.abs(lag) < 0.5 * shape["width"] * (1.0 - 1e-9)
        pace = np.gradient(path, run.period)
        mass = second_difference(lag, run.period)
        rubs = (np.sign(pace + np.gradient(lag, run.period)) - np.sign(pace)) * crossing
        parts = [mass + shape["braking"] * rubs] if "braking" in shape else [mass, -np.sign(pace) * crossing]
        return Signature({self.channels(site)[0]: column(*(run.to_grid(x[:, None])[:, 0] for x in parts))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the width, and the mass and the friction behind it: coefficients (2,), with a braking (1,)."""
        mass = float(coefficients[0])
        friction = mass * shape["braking"] if "braking" in shape else float(coefficients[1])
        return {"width": shape["width"], "load_mass": mass, "load_friction": friction}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load, the first of (p,), is a fair share of the axis' mass, and its friction resists."""
        return super().admissible(shape, coefficients) and bool((coefficients[1:] >= 0.0).all())


class BacklashBeforeEncoder(Page):
    """reading = follower behind a gap of `width` of the lagged reference; the only encoder is at the load.

    A servo that sticks gives the same readings: the two are rivals until another load, or the effort, is recorded.
    """

    id, family, stage = Backlash.id, Backlash.family, Backlash.stage
    kinds = ("servo",)
    needs = ("behind",)
    inputs = ("command", "direction")
    best = Best("loads", "a load that always pushes to one flank closes a gap, and leaves friction as it is")
    on_axis = Backlash.on_axis
    explanation = "The load does not answer a reversal of its reference until the motor has crossed a fixed travel."
    siblings = {"coulomb_friction": "the same readings under one load; a gap is gone under a weight"}
    units: ClassVar[Mapping[str, str]] = {"width": "m", "late": "s"}
    finer = ServoStiction.finer
    indistinct = (ServoStiction.id,)
    STICKS = ServoStiction()
    """The page whose law gives the same readings."""
    TRIED = 16
    """Widths that are tried for the smallest one that would show."""

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the tracking error."""
        return self.STICKS.channels(site)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return half widths, m or rad, and lags, s."""
        return [s for s in self.STICKS.shapes(views, site) if "displacement" not in s]

    def allowed(self, views: Sequence[AxisView], site: str, shape: Shape) -> bool:
        """Return whether the reference crosses the gap."""
        return self.STICKS.allowed(views, site, shape)

    def least_shown(self, views: Sequence[AxisView], site: str, hidden: Hidden) -> str:
        """Return the smallest play, between a count and the travel."""
        count, travel = hidden.step, max(v.axis(site).travel for v in views)
        widths = np.geomspace(count, max(travel, 2.0 * count), self.TRIED)
        least = next((w for w in widths if hidden.shows({"force": 0.5 * float(w), "late": 0.0})), None)
        said = f"play before it above {rounded(least, hidden.units[0])}" if least else "no play before it"
        return f"{said} would show"

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return minus the play of the lagged reference; nothing is left to fit."""
        return self.STICKS.signature(view, site, shape)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the width, and how late the servo is before the gap [s]; there are no coefficients, (0,)."""
        return {"width": 2.0 * shape["force"], **({"late": shape["late"]} if shape["late"] else {})}
