"""A spring behind the only encoder of an axis: the effort that shakes the load shows its resonance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_diagnosis.words import rounded

from sher3_effects.behind_motor import BehindMotor
from sher3_effects.compliance.transmission_compliance import TransmissionCompliance
from sher3_effects.operators import oscillator, second_difference
from sher3_effects.page import Hidden
from sher3_effects.view import AxisView


class ComplianceBehindMotor(BehindMotor):
    """effort = mass a + load_mass d'', d'' + 2 z w d' + w^2 d = -a the load's lag, stiffness = load_mass w^2."""

    id, family, stage = TransmissionCompliance.id, TransmissionCompliance.family, TransmissionCompliance.stage
    inputs = ("acceleration",)
    best = Best("sweep", "a sweep through its resonance shows a load on a spring")
    leaves_out = "what damps it"
    explanation = "The load hangs on a spring: near its resonance the effort is not what a rigid mass needs."
    siblings = {"backlash": "a fixed travel, whatever the frequency"}
    units: ClassVar[Mapping[str, str]] = {"stiffness": "N/m", "frequency": "Hz", "load_mass": "kg"}
    FREQUENCIES = tuple(np.geomspace(3.0, 60.0, 16))
    """Hz; twice the engine's bandwidth beyond which nothing is left of a resonance is above them."""
    OF_RATE = 0.3
    """Share of the sampling rate that a resonance stays below."""
    DAMPINGS = (0.03, 0.1, 0.3)
    MOST_DAMPED = 0.35
    """Damping beyond which no resonance stands out, which alone tells a spring from a late effort: it swings out by a
    half more than its motor there."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "frequency": (0.85, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.18),
        "damping": (0.5, 0.8, 1.25, 2.0),
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return frequencies of the load on its spring while the motor is held, Hz, and dampings."""
        if not self.weighs(views, site):
            return []
        sampled = [f for f in self.FREQUENCIES if f * views[0].run.period < self.OF_RATE]
        return [{"frequency": f, "damping": z} for f in sampled for z in self.DAMPINGS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: the acceleration of the load beyond that of the motor."""
        run, pace = view.run, 2.0 * np.pi * shape["frequency"]
        shaken = np.gradient(run.velocity[:, [view.row(site)]], run.period, axis=0) / pace**2
        lag = oscillator(-shaken, shape["frequency"], min(shape["damping"], self.MOST_DAMPED), run.period)
        return Signature({self.channels(site)[0]: column(run.to_grid(second_difference(lag, run.period))[:, 0])})

    def least_shown(self, views: Sequence[AxisView], site: str, hidden: Hidden) -> str:
        """Return the stiffest spring."""
        shapes = [s for s in self.shapes(views, site) if s["damping"] == self.DAMPINGS[1]]
        fastest_first = sorted(shapes, key=lambda s: -s["frequency"])
        pace = next((s["frequency"] for s in fastest_first if hidden.shows(s)), None)
        if pace is None:
            return "no spring would show"
        stiffness, (position, force) = hidden.mass * (2.0 * np.pi * pace) ** 2, hidden.units
        return f"a spring below {rounded(stiffness, f'{force}/{position}')} ({pace:.2g} Hz) would show"

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return frequency [Hz] and damping, the mass (1,) of the load and the stiffness of its spring."""
        mass = float(coefficients[0])
        return {**shape, "load_mass": mass, "stiffness": mass * (2.0 * np.pi * shape["frequency"]) ** 2}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load, coefficients (1,), is a fair share of the axis' mass, and its spring rings."""
        return super().admissible(shape, coefficients) and shape["damping"] < self.MOST_DAMPED
