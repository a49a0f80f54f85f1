"""A spring behind the only encoder of an axis: the effort that shakes the load shows its resonance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.compliance.transmission_compliance import TransmissionCompliance
from sher3_effects.operators import bent, oscillator
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class ComplianceBehindMotor(Page):
    """effort = mass a + load_mass d'', d'' + 2 z w d' + w^2 d = -a the load's lag, stiffness = load_mass w^2.

    Attributes:
        mass: all that moves, kg or kg m^2; that of the load is a part of it.
    """

    id, family, stage = TransmissionCompliance.id, TransmissionCompliance.family, TransmissionCompliance.stage
    kinds = ("axis",)
    needs = ("alone", "drive")
    inputs = ("acceleration",)
    best = Best("sweep", "a sweep through its resonance shows a load on a spring")
    leaves_out = "what damps it"
    explanation = "The load hangs on a spring: near its resonance the effort is not what a rigid mass needs."
    siblings = {"backlash": "a fixed travel, whatever the frequency"}
    units: ClassVar[Mapping[str, str]] = {"stiffness": "N/m", "frequency": "Hz", "load_mass": "kg"}
    on_axis: ClassVar[Mapping[str, str]] = {}
    FREQUENCIES = tuple(np.geomspace(3.0, 60.0, 16))
    """Hz; twice the engine's bandwidth beyond which nothing is left of a resonance is above them."""
    OF_RATE = 0.3
    """Share of the sampling rate that a resonance stays below."""
    LEAST_SHARE = 0.05
    """Share of the mass that must hang on the spring, at least: less is an error of the mass."""
    DAMPINGS = (0.03, 0.1, 0.3)
    MOST_DAMPED = 0.35
    """Damping beyond which no resonance stands out, which alone tells a spring from a late effort: it swings out by a
    half more than its motor there."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "frequency": (0.85, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.18),
        "damping": (0.5, 0.8, 1.25, 2.0),
    }

    def __init__(self, mass: float = np.inf) -> None:
        self.mass = mass

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the force balance."""
        return (Channel("motor_mechanics", site),)

    def stage_at(self, channel: Channel) -> str:
        """Return the transmission: the spring is there, though the effort shows it."""
        return self.stage

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return frequencies of the load on its spring while the motor is held, Hz, and dampings."""
        if views[0].axis(site).mass <= 0.0 or any(v.run.effort is None for v in views):
            return []
        told = [f for f in self.FREQUENCIES if f * views[0].run.period < self.OF_RATE]
        return [{"frequency": f, "damping": z} for f in told for z in self.DAMPINGS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: the acceleration of the load beyond that of the motor."""
        run, pace = view.run, 2.0 * np.pi * shape["frequency"]
        shaken = np.gradient(run.velocity[:, [view.row(site)]], run.period, axis=0) / pace**2
        lag = oscillator(-shaken, shape["frequency"], min(shape["damping"], self.MOST_DAMPED), run.period)
        return Signature({self.channels(site)[0]: column(run.to_grid(bent(lag[:, 0], run.period)[:, None])[:, 0])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return frequency and damping, the mass of the load and the stiffness of its spring."""
        mass = float(coefficients[0])
        return {**shape, "load_mass": mass, "stiffness": mass * (2.0 * np.pi * shape["frequency"]) ** 2}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load has a mass worth the name and no more than all, and its spring rings."""
        least = self.LEAST_SHARE * self.mass if np.isfinite(self.mass) else 0.0
        return bool(least < coefficients[0] < self.mass and shape["damping"] < self.MOST_DAMPED)
