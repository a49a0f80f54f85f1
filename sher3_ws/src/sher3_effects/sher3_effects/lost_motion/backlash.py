"""Backlash: a gap between motor and load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Measured, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.compliance.transmission_compliance import carried
from sher3_effects.lost_motion.plateau import plateau
from sher3_effects.operators import flight, released_play
from sher3_effects.page import Page, Part, Values
from sher3_effects.view import AxisView, without_force

FIRST, HARDLY = 25, 0.05
"""Samples at the start that say on which side of a gap a load lies, and the travel meanwhile, in widths."""


class Backlash(Page):
    """load = follower behind a gap of `width`; between the flanks the load drifts under its own weight and load."""

    id, family, stage = "backlash", "lost_motion", "transmission"
    inputs = ("position", "direction", "load", "weight")
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    needs = ("load",)
    best = Best("loads", "known loads at rest separate a fixed gap from a spring")
    companion = "friction"
    on_axis = {"width": "backlash"}
    units: ClassVar[Mapping[str, str]] = {"lost": "m", "release": "m"}
    leaves_out = "the elasticity of its contact"
    explanation = (
        "After a reversal the motor moves by a fixed amount before the load follows; a load that pushes the "
        "other way takes the load across the gap without the motor moving."
    )
    siblings = {
        "transmission_compliance": "in proportion to the force, no fixed width",
        "transmission_hysteresis": "the lag builds up over a stroke much longer than itself",
        "joint_clearance": "the encoders agree, the tip jumps",
    }
    WIDTHS = (0.7, 0.8, 0.9, 1.0, 1.1, 1.25)
    """In spans of the residual."""
    DRIFTS = ((np.inf, 0.0), (1000.0, 0.0), (200.0, 0.0), (1000.0, 1.0), (200.0, 1.0))
    """How the load moves in the gap: viscous drag in units of the nominal coefficient over 60, and whether the friction
    of the axis holds it until the pull on it is larger."""
    RELEASES = (0.15, 0.4, 1.0)
    """Travel over which the friction of the load gives way before it slides, in widths."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "width": (0.94, 0.97, 1.03, 1.06),
        "damping": (0.5, 2.0),
        "stick": (0.8, 1.2),
        "release": (0.5, 0.7, 1.4, 2.0),
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Width around the span of the residual, and how freely the load moves in the gap."""
        axis = views[0].row(site)
        lags = [v.run.to_grid(v.run.load - v.run.motor)[:, axis] for v in views if v.run.load is not None]
        span = max((float(np.ptp(np.percentile(lag, [1, 99]))) for lag in lags), default=0.0)
        if span == 0.0:
            return []
        stick = resting_force(views, site)
        return [{"width": w * span, "damping": d, "stick": s * stick} for w in self.WIDTHS for d, s in self.DRIFTS]

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the shape with a load that follows its flank back before the gap opens: its friction is elastic."""
        stick = max(shape.get("stick", 0.0), resting_force(views, site))
        if "damping" not in shape or stick == 0.0:
            return []
        return [{**shape, "stick": stick, "release": r * shape["width"]} for r in self.RELEASES]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """No coefficient: the width is the shape. The side at the start is the side that fits the first samples."""
        axis, run = view.row(site), view.run
        clock, stick, release = run.stage_clock, shape["stick"], shape.get("release", 0.0)
        pull = np.interp(clock, clock[run.grid], view.path.contact_force[:, axis] - view.path.gravity[:, axis])
        held = np.clip(pull, -stick, stick)
        damping = shape["damping"] * view.axis(site).viscous / 60.0
        start = self.start(view, site, shape["width"])
        rest = held * (release / stick) if release else np.zeros_like(held)
        lag = released_play(run.smooth[:, axis], pull - held, rest, release, shape["width"], damping, run.period, start)
        return Signature({}, {Channel(self.stage, site): run.to_grid(lag)[:, None]})

    def start(self, view: AxisView, site: str, width: float) -> float:
        """Return where in a gap the load begins, -1..1, as the first samples say."""
        run, axis = view.run, view.row(site)
        first = (run.load[:FIRST, axis] - run.motor[:FIRST, axis]).mean() if run.load is not None else 0.0
        return float(np.clip(2.0 * first / width, -1.0, 1.0))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return width of the gap, travel lost between both directions, and that over which a load leaves its flank.

        All of them are of the shape; there are no coefficients, (0,).
        """
        more = {"release": shape["release"]} if "release" in shape else {}
        return {"width": shape["width"], "lost": shape["width"], **more}

    def measured(self, views: Sequence[AxisView], site: str, shape: Shape) -> Mapping[str, Measured]:
        """Return the width of the gap without the give of its flanks, where the plateaus tell it."""
        found = plateau(views, site, shape["width"], resting_force(views, site))
        return {"width": Measured(found.width, found.error)} if found else {}

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return a rigid gap that loses as much travel."""
        return [Part(self.id, actuator, {"width": values.get("lost", values["width"])})]


class BacklashOnAxis(Backlash):
    """The same on one axis of any machine, where something else may make most of the encoders' difference."""

    kinds: ClassVar[tuple[str, ...]] = ("axis", "servo")
    gives = ("width",)
    parameters = Page.parameters
    units: ClassVar[Mapping[str, str]] = {}
    plain = True
    amount = "width"
    SMALLER = (0.06, 0.12, 0.25, 0.45)
    """Widths in spans of the residual that are tried for a load that stays put in the gap."""
    SOFT = (0.001, 0.01, 0.05)
    """Known force from outside over its rms within which the load is between the flanks."""
    BRAKING = (0.03, 0.1, 0.3, 1.0)
    """What brakes a load that flies across the gap by its own inertia, over the rms acceleration of the motor."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "width": (0.7, 0.85, 0.94, 0.97, 1.03, 1.06, 1.2, 1.4),
        "damping": (0.5, 2.0),
        "stick": (0.8, 1.2),
        "braking": (0.5, 2.0),
        "soft": (0.5, 2.0),
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the widths around the span and smaller ones, for loads that stay, drift, or fly on by their mass."""
        found = super().shapes(views, site)
        span = found[0]["width"] / self.WIDTHS[0] if found else 0.0
        small = [{"width": w * span, "damping": np.inf, "stick": 0.0} for w in self.SMALLER if span]
        loaded = any(v.path.contact_force.any() for v in views)
        usual = float(np.sqrt(np.mean([np.mean(carried(v, site, 0.0) ** 2) for v in views]))) if loaded else 0.0
        small += [{"soft": s * usual} for s in self.SOFT if usual and span]
        square = [np.mean(np.gradient(v.run.velocity[:, v.row(site)], v.run.period) ** 2) for v in views]
        usual = float(np.sqrt(np.mean(square)))
        widths = [w * span for w in (*self.SMALLER[2:], *self.WIDTHS) if span]
        found = [*found, *small, *({"width": w, "braking": b * usual} for w in widths for b in self.BRAKING if usual)]
        seen = np.inf if loaded else max(np.ptp(v.run.motor[:, v.row(site)]) for v in views)
        return [shape for shape in found if shape.get("width", 0.0) < seen]  # no motion shows a gap wider than itself

    def plain_shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return gaps in which a load stays put, where no force was recorded: a ratio takes a part of their span."""
        found = self.shapes(views, site) if without_force(views) else []
        return [s for s in found if s.get("damping") == np.inf and s["stick"] == 0.0]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the lag behind a gap; a load with a `braking` (m/s^2) keeps its speed in the gap but for this braking.

        Where a known force says on which flank the load lies, one column: minus half its side.
        """
        if "soft" in shape:
            side = np.tanh(carried(view, site, 0.0) / shape["soft"])
            return Signature({Channel(self.stage, site): column(-0.5 * side)})
        if "braking" not in shape:
            return super().signature(view, site, shape)
        axis, run = view.row(site), view.run
        start = self.start(view, site, shape["width"])
        lag = flight(np.ascontiguousarray(run.smooth[:, axis]), shape["width"], shape["braking"], run.period, start)
        return Signature({}, {Channel(self.stage, site): run.to_grid(lag)[:, None]})

    def start(self, view: AxisView, site: str, width: float) -> float:
        """Return where the load begins, by the samples at which the motor has hardly moved: its zero is free."""
        run, axis = view.run, view.row(site)
        assert run.load is not None
        apart, moved = run.load[:, axis] - run.motor[:, axis], np.abs(run.motor[:FIRST, axis] - run.motor[0, axis])
        middle = np.percentile(apart, [1.0, 99.0]).mean()
        first = apart[:FIRST][moved < HARDLY * width].mean() - middle
        return float(np.clip(2.0 * first / width, -1.0, 1.0))

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load gives way to the force: coefficients (1,) above zero; without one, True."""
        return "soft" not in shape or bool(coefficients[0] > 0.0)

    def measured(self, views: Sequence[AxisView], site: str, shape: Shape) -> Mapping[str, Measured]:
        """Return none: other effects make most of the encoders' difference, and stand on the plateaus as well."""
        return {}


class BacklashOfJoint(BacklashOnAxis):
    """The same on a joint of a serial arm with a second encoder at its link: the force on the link says on which flank.

    A joint whose link needs little force crosses the gap where the motor turns round, as on one axis.
    """

    kinds = ("joint",)
    SOFT = (0.01, 0.04, 0.15)
    """Force over the rms one within which the link is between the flanks."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the shapes of one axis, and those whose flank follows the force."""
        force = [float(np.mean(v.inertial[:, v.row(site)] ** 2)) for v in views]
        usual = float(np.sqrt(np.mean(force)))
        return [*super().shapes(views, site), *({"soft": s * usual} for s in self.SOFT if usual)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column where the force tells the flank: minus half its side; else the lag behind a gap."""
        if "soft" not in shape:
            return super().signature(view, site, shape)
        side = np.tanh(view.inertial[:, view.row(site)] / shape["soft"])
        return Signature({Channel(self.stage, site): column(-0.5 * side)})


def resting_force(views: Sequence[AxisView], site: str) -> float:
    """Typical force against the motion beyond the nominal one, N: what holds a load that nothing else moves."""
    held = []
    for view in views:
        if view.run.effort is None:
            continue
        axis = view.row(site)
        moving = np.abs(view.velocity[:, axis]) > 0.02 * view.axis(site).top
        extra = view.run.to_grid(view.run.effort)[:, axis] - view.inertial[:, axis]
        held.append((extra * np.sign(view.velocity[:, axis]))[moving & view.run.loaded_ok])
    return max(0.0, float(np.median(np.concatenate(held)))) if held and sum(map(len, held)) > 50 else 0.0


class TableReversal(Page):
    """Reversal error of a positioning table: it stops short of its target, from either side, by half the width."""

    id, family, stage, best = Backlash.id, Backlash.family, Backlash.stage, Backlash.best
    kinds: ClassVar[tuple[str, ...]] = ("table",)
    inputs, on_axis = Backlash.inputs, Backlash.on_axis
    explanation = "The table stops at another place when it comes from the other side."
    siblings = {"transmission_hysteresis": "the lag builds up over a stroke much longer than itself"}
    gives = ("width",)
    units = {"width": "m"}
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {"width": (-np.inf, np.inf)}

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return one shape, where the targets were reached from both sides."""
        return [{}] if any(np.ptp(v.direction) > 0.0 for v in views) else []

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return one column: minus half the direction of approach of a `TableView`."""
        return Signature({Channel(self.stage, site): column(-0.5 * view.direction)})


class CircleReversal(TableReversal):
    """Reversal error of one of two axes that move on a circle: a step at the poles where that axis turns round."""

    kinds, places = ("circle",), ("axis",)
    shapes = Page.shapes
    explanation = "One axis lags behind after it turns round: the circle has a step on both of its poles."
    siblings = {"transmission_ripple": "a wave over the whole circle, not a step"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the radius of the plane."""
        return (Channel("mechanism", site.partition(".")[0]),)

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return one column: what half a width, against the motion of an axis of a `CircleView`, does to the radius."""
        across = view.across(site)
        return Signature({self.channels(site)[0]: column(-0.5 * view.moving(site) * across)})


@dataclass(frozen=True)
class BacklashInPlant(PlantEffect, page=Backlash):
    """A gap between motor and load: after a reversal the load waits until the motor has crossed it."""

    width: float = parameter("m", 5e-6, 0.0, 1e-3, "of the gap", on="backlash")
