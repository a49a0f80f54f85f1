"""Transmission ripple: the load runs ahead and behind periodically."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter, set_to

from sher3_effects.page import Page, Tolerated
from sher3_effects.periodic.phase import orders_of, phase_at_zero, sine_of
from sher3_effects.table_view import TableView
from sher3_effects.view import AxisView


class TransmissionRipple(Page):
    """load = motor + A sin(2 pi n q / lead + phase), with a second and a third order, or teeth unlike each other."""

    id, family, stage = "transmission_ripple", "periodic", "transmission"
    inputs = ("position",)
    needs = ("load", "lead")
    discrete = frozenset({"periods_per_rev"})
    best = Best("sweep", "constant speeds over several revolutions separate periods")
    leaves_out = "further harmonics"
    bent_from = 0.01
    """Half of what is asked of other laws: a third order has taken most of what they leave."""
    explanation = (
        "The load moves ahead and behind the motor, n times per lead; the load encoder sees it and the tip follows."
    )
    siblings = {
        "encoder_eccentricity": "only the reading swings, the tip does not",
        "cogging": "a force, not a displacement",
    }
    tried = tuple({"periods_per_rev": float(n), "side": 0.0} for n in (*range(1, 10), *range(10, 21, 2)))
    """Periods per lead."""

    def refine(self, shape: Shape) -> list[Shape]:
        """Add a second order: the first, a neighbour (side-band), or a harmonic; and then a third."""
        if "unlike" in shape:
            return []
        n, side = shape["periods_per_rev"], shape["side"]
        sides = sorted({1.0, n - 1.0, n + 1.0, 2.0 * n, 3.0 * n} - {0.0, n})
        found: list[Shape] = [{**shape, "side": s} for s in sides]
        if side and "third" not in shape:
            found += [{**shape, "third": s} for s in sides if s != side]
        return found

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return a gear of the same number of teeth, of which no two are alike: orders beside it show too."""
        return [{"periods_per_rev": shape["periods_per_rev"], "side": 0.0, "unlike": 1.0}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns per order: the quadratures."""
        axis = view.row(site)
        turn = 2.0 * np.pi * view.run.smooth[:, axis] / view.lead(site)
        orders = [*orders_of(shape), *(n for n in (shape["side"], shape.get("third", 0.0)) if n)]
        waves = [view.run.to_grid(f(n * turn)) for n in orders for f in (np.sin, np.cos)]
        return Signature({Channel(self.stage, site): column(*waves)})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the ripple once per revolution, its quadratures."""
        rotary = site == "roll"
        limit = (robot.tolerances.ripple_roll if rotary else robot.tolerances.ripple, "rad" if rotary else "m")
        waves = {f"ripple of {site}, {wave}": limit for wave in ("sine", "cosine")}
        return (Tolerated({"periods_per_rev": 1.0, "side": 0.0}, waves),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude, order and phase [rad], of the first two of (p,)."""
        return sine_of(shape, coefficients)


class RippleOnAxis(TransmissionRipple):
    """The same on one axis of any machine: three orders at most."""

    kinds = ("axis", "servo")
    bends = Page.bends


class RippleOfAnyPeriod(TransmissionRipple):
    """The same on an axis whose lead nobody states: load = motor + A sin(2 pi q / period + phase)."""

    kinds, needs = ("axis", "servo"), ("load", "no_lead")
    bends = Page.bends
    refine = Page.refine
    discrete = frozenset({"period"})
    finer: ClassVar[dict[str, tuple[float, ...]]] = {"period": (0.98, 0.993, 1.007, 1.02)}
    units = {"amplitude": "m", "period": "m", "phase": "rad"}
    COUNT = 3
    """Periods that are tried; each is then searched more finely."""

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the periods that stand out in the record with the longest travel."""
        longest = max(views, key=lambda view: view.axis(site).travel)
        return [{"period": 2.0 * np.pi / n} for n in longest.orders(site, self.COUNT)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the quadratures."""
        turn = 2.0 * np.pi * view.run.smooth[:, view.row(site)] / shape["period"]
        waves = (view.run.to_grid(wave(turn)) for wave in (np.sin, np.cos))
        return Signature({Channel(self.stage, site): column(*waves)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude, the travel of a period and phase [rad], of coefficients (2,)."""
        return sine_of(shape, coefficients, "period")


class TableRipple(Page):
    """A wave of a positioning table over its target, with a whole number of periods for each turn of the screw."""

    id, family, stage = TransmissionRipple.id, TransmissionRipple.family, TransmissionRipple.stage
    best, explanation = TransmissionRipple.best, TransmissionRipple.explanation
    kinds, needs, inputs = ("table",), ("lead",), ("position",)
    parameters = TransmissionRipple.parameters
    discrete = frozenset({"periods_per_rev"})
    units = {"amplitude": "m"}
    siblings = {"lead_error": "in proportion to the travel, no wave"}
    tried = tuple({"periods_per_rev": float(n)} for n in (1, 2, 4))
    """Periods per lead that targets, a few to the lead at best, can show."""

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return two columns: the quadratures of a wave over the target."""
        assert view.lead is not None
        turn = 2.0 * np.pi * shape["periods_per_rev"] * view.target / view.lead
        return Signature({Channel(self.stage, site): column(np.sin(turn), np.cos(turn))})


@dataclass(frozen=True)
class TransmissionRippleInPlant(PlantEffect, page=TransmissionRipple):
    """The load runs ahead and behind within a revolution: screw drunkenness, kinematic error of the harmonic drive."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the load's motion", on="ripple_amplitude", change=set_to)
    periods_per_rev: float = parameter("1", 1.0, 0.5, 200.0, "periods per lead", on="ripple_periods", change=set_to)
    phase: float = phase_at_zero("ripple_phase")
    base_amplitude: float = parameter(
        "m", 0.0, 0.0, 1e-3, "of a companion with one period per lead", on="ripple_base_amplitude", change=set_to
    )
    base_phase: float = phase_at_zero("ripple_base_phase")
