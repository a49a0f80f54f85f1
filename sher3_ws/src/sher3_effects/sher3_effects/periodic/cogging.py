"""Cogging: a force that repeats with the motor angle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter, set_to

from sher3_effects.page import Page
from sher3_effects.periodic.phase import orders_of, phase_at_zero, sine_of
from sher3_effects.view import ArmMotionView, AxisView


class Cogging(Page):
    """F = A sin(2 pi n q / lead + phase); teeth may be unlike each other, and no sines."""

    id, family, stage = "cogging", "periodic", "motor_mechanics"
    inputs = ("position",)
    needs: ClassVar[tuple[str, ...]] = ("lead",)
    discrete = frozenset({"periods_per_rev"})
    best = Best("sweep", "constant speeds over several revolutions separate periods")
    leaves_out = "further harmonics"
    explanation = (
        "A force that repeats several times per motor revolution, the same in both directions and at every speed."
    )
    siblings = {
        "position_friction": "the sign follows the direction of motion",
        "transmission_ripple": "the load moves, no force is needed",
    }
    tried = tuple({"periods_per_rev": float(n)} for n in (*range(1, 12), *range(12, 25, 2)))
    """Periods per motor revolution."""

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return a motor of the same number of teeth, of which no two are alike: orders beside it show too."""
        return [{**shape, "unlike": 1.0}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns, the quadratures, low-passed as the residual is; with unlike teeth those of other orders too."""
        turn = 2.0 * np.pi * view.run.smooth[:, view.row(site)] / view.lead(site)
        waves = [wave(k * turn) for k in orders_of(shape) for wave in (np.sin, np.cos)]
        return Signature({Channel(self.stage, site): column(*(view.run.to_grid(w) for w in waves))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude, order and phase [rad], of the first two of (p,)."""
        return sine_of(shape, coefficients)


class CoggingOnAxis(Cogging):
    """The same on one axis of any machine: one sine."""

    kinds = ("axis",)
    bends = Page.bends


class CoggingOnJoint(Cogging):
    """The same on a joint of an arm, whose gear nobody states: F = A sin(n q + phase), n as the efforts show it."""

    kinds, needs = ("joint",), ()
    bends = Page.bends
    discrete = frozenset({"periods_per_turn"})
    finer: ClassVar[dict[str, tuple[float, ...]]] = {"periods_per_turn": (0.98, 0.993, 1.007, 1.02)}
    units = {"amplitude": "N", "phase": "rad"}
    on_axis = {"amplitude": "cogging", "periods_per_turn": "cogging_periods", "phase": "cogging_phase"}
    COUNT = 3
    """Orders that are tried; each is then searched more finely."""

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the orders that stand out in the record with the longest travel."""
        longest: ArmMotionView = max(views, key=lambda v: float(np.ptp(v.run.smooth[:, v.row(site)])))
        return [{"periods_per_turn": n} for n in longest.orders(site, self.COUNT)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the quadratures."""
        turn = shape["periods_per_turn"] * view.run.smooth[:, view.row(site)]
        waves = (view.run.to_grid(wave(turn)[:, None])[:, 0] for wave in (np.sin, np.cos))
        return Signature({Channel(self.stage, site): column(*waves)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude, periods per turn of the joint (per 2 pi m of one that slides) and phase [rad], of (2,)."""
        return sine_of(shape, coefficients, "periods_per_turn")


@dataclass(frozen=True)
class CoggingInPlant(PlantEffect, page=Cogging):
    """Magnets pull the rotor towards the teeth: a force that repeats with the motor's angle, alike both ways."""

    amplitude: float = parameter("N", 0.5, 0.0, 50.0, "of the force", on="cogging_amplitude", change=set_to)
    periods_per_rev: float = parameter("1", 12.0, 0.5, 200.0, "periods per lead", on="cogging_periods", change=set_to)
    phase: float = phase_at_zero("cogging_phase")
