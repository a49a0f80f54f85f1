"""Transmission compliance: the load gives way in proportion to the force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.compliance.two_slopes import BENT_FROM, finer, is_shown, knees, parts, slopes
from sher3_effects.operators import oscillator
from sher3_effects.page import Page
from sher3_effects.view import AxisView

SLOPES = {"stiffness": "N/m", "compliance": "m/N", "knee": "N", "stiffness_beyond": "N/m"}
"""Units of a spring of two slopes."""
MOST_DAMPED = 0.95
"""Damping beyond which nothing rings."""
PLANT_NAMES = {"load_mass": "load_share", "frequency": "frequency", "damping": "damping"}
"""Part of the shape -> parameter of the plant that it is."""


class TransmissionCompliance(Page):
    """load = motor - force / stiffness, force what the load side needs."""

    id, family, stage = "transmission_compliance", "compliance", "transmission"
    inputs = ("force", "weight", "load", "acceleration")
    above = 0.0
    needs = ("load",)
    best = Best("loads", "known loads in several postures separate springs")
    leaves_out = "how it hardens, and that it grows with the free length of a screw"
    companion = "friction"
    explanation = (
        "Between motor and load lies a spring: their difference follows weight, external load and acceleration."
    )
    siblings = {
        "backlash": "a fixed width, whatever the force",
        "transmission_hysteresis": "follows the path, not the force",
    }
    units = {"stiffness": "N/m"}
    on_axis = {"compliance": "compliance"}
    polished = ("load_mass", "frequency", "damping")

    FREQUENCIES = (8.0, 11.0, 14.0, 17.0, 20.0, 24.0, 28.0, 34.0, 40.0, 50.0)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Share of the axis' mass on the load side.

        Resonance of that mass on the spring (0: far above the bandwidth).
        """
        static: list[Shape] = [{"load_mass": s, "frequency": 0.0, "damping": 0.0} for s in (0.0, 0.1, 0.3, 1.0)]
        frequencies = self.shown(views)
        ringing = [{"load_mass": s, "frequency": f, "damping": 0.1} for s in (0.1, 0.3) for f in frequencies]
        return [*static, *ringing]

    def shown(self, views: Sequence[AxisView]) -> list[float]:
        """Return the frequencies that a record can show, Hz: two samples a swing are the fewest."""
        return [f for f in self.FREQUENCIES if all(2.0 * f * view.run.period < 1.0 for view in views)]

    def refine(self, shape: Shape) -> list[Shape]:
        """Return shapes near this one: other frequencies, dampings and shares of the mass on the spring."""
        if not shape["frequency"]:
            return [{**shape, "load_mass": s} for s in (0.03, 0.06, 0.2, 0.5)]
        near = [{**shape, "frequency": shape["frequency"] * f} for f in (0.9, 0.95, 1.05, 1.1)]
        return [*near, *({**shape, "damping": z} for z in (0.02, 0.05, 0.2, 0.4)), {**shape, "load_mass": 0.5}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: minus the force on the spring, ringing; the motor feels the load's mass move against it."""
        run = view.run
        mass = shape["load_mass"] * view.axis(site).mass
        if not shape["frequency"]:
            return Signature({Channel(self.stage, site): column(-run.to_grid(needed(view, site, shape["load_mass"])))})
        force = (weighed(view, site) + mass * held(run.acceleration[:, view.row(site)]))[:, None]
        pace = min(shape["frequency"], 0.5 / run.period)
        bend = oscillator(force, pace, min(shape["damping"], MOST_DAMPED), run.period)[:, 0]
        back = mass * np.gradient(np.gradient(bend, run.period), run.period)
        motor = Channel("motor_mechanics", site)
        return Signature({Channel(self.stage, site): column(-run.to_grid(bend)), motor: column(-run.to_grid(back))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return stiffness and its inverse, first of (p,); the share of the axis' mass it carries, how it swings."""
        c = float(coefficients[0])
        carried = {PLANT_NAMES[k]: float(shape[k]) for k in PLANT_NAMES if shape.get(k)}
        return {"stiffness": 1.0 / c if c else 0.0, "compliance": c, **carried}


def needed(view: AxisView, site: str, share: float) -> Array:
    """Return the force (n,) that a load needs: weight, known loads, and a share of the axis' mass that it moves."""
    mass, velocity = share * view.axis(site).mass, view.run.velocity[:, view.row(site)]
    return weighed(view, site) + mass * np.gradient(velocity, view.run.period)


def weighed(view: AxisView, site: str) -> Array:
    """Return weight and known loads (n,) on an axis."""
    axis, clock = view.row(site), view.run.stage_clock
    return np.interp(clock, clock[view.run.grid], view.path.gravity[:, axis] - view.path.contact_force[:, axis])


def held(acceleration: Array) -> Array:
    """Return the mean over the tick to come (n,) of an acceleration read at the ticks.

    The motion is taken unfiltered: an oscillator that is driven a tick late, or by a smaller amplitude, is fitted with
    another frequency.
    """
    return 0.5 * (acceleration + np.append(acceleration[1:], acceleration[-1]))


class ComplianceOnAxis(TransmissionCompliance):
    """load = motor - force / stiffness on one axis of any machine; the force as modelled or as the drive recorded it.

    Without a recorded force a ringing load tells its frequency, and its stiffness only with its share of the mass.
    Where the mass of the load is known its friction bends the spring too; half a gap times the stiffness adds to it.
    Beyond a `knee` the spring may have another slope: load = motor - knee / stiffness - (force - knee) /
    stiffness_beyond.
    """

    kinds = ("axis", "servo")
    units = {**SLOPES, "frequency": "Hz", "load_friction": "N"}
    bent_from = BENT_FROM
    DAMPINGS = (0.03, 0.1, 0.3)
    """Of a load that rings behind the motor, whose mass and spring nobody knows."""
    OF_LOAD = 2.0
    """Value of the shape `recorded` for the force that the mass of the load needs."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the shapes of the modelled force, and a shape of the recorded force where it was recorded."""
        recorded = any(v.run.effort is not None and v.run.effort.any() for v in views)
        held: Shape = {"load_mass": 0.0, "frequency": 0.0, "damping": 0.0, "recorded": 1.0}
        modelled: list[Shape] = [{**held, "recorded": 0.0}]
        if views[0].axis(site).load_mass > 0.0:
            return [{**held, "recorded": self.OF_LOAD}, {**held, "recorded": self.OF_LOAD, "rubbed": 1.0}, held]
        if views[0].axis(site).mass > 0.0:
            modelled = super().shapes(views, site)
        elif not recorded:
            modelled += [
                {"ringing": 1.0, "frequency": f, "damping": z} for f in self.shown(views) for z in self.DAMPINGS
            ]
        return [*modelled, held] if recorded else modelled

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return knees of a spring that does not ring; of one whose load rubs, by the recorded force."""
        if "ringing" in shape or shape["frequency"]:
            return []
        rigid = {
            **{k: x for k, x in shape.items() if k != "rubbed"},
            **({"recorded": 1.0} if "rubbed" in shape else {}),
        }
        if rigid.get("recorded") == 1.0 and any(v.run.effort is None for v in views):
            return []
        return knees((self._force(v, site, rigid) for v in views), rigid)

    def refine(self, shape: Shape) -> list[Shape]:
        """Return neighbours of a modelled force, or of a knee; a recorded one has none."""
        if "knee" in shape:
            return finer(shape)
        if "ringing" in shape:
            near = [{**shape, "frequency": shape["frequency"] * f} for f in (0.9, 0.95, 0.98, 1.02, 1.05, 1.1)]
            return [*near, *({**shape, "damping": shape["damping"] * z} for z in (0.5, 0.8, 1.25, 2.0))]
        return [] if "recorded" in shape else super().refine(shape)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return stiffness and compliance, of coefficients (p,), and the frequency [Hz] of a load that rings."""
        if "ringing" in shape:
            return {"frequency": shape["frequency"], "damping": shape["damping"]}
        more = {"frequency": shape["frequency"]} if shape["frequency"] else {}
        if "rubbed" in shape and coefficients[0]:
            more = {"load_friction": float(coefficients[1] / coefficients[0])}
        return {**super().parameters(shape, coefficients), **slopes(shape, coefficients), **more}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether coefficients (p,) are of a spring whose load resists; a load that rings has none."""
        if "ringing" in shape:
            return shape["damping"] < MOST_DAMPED
        if "knee" in shape:
            return bool((coefficients[:2] > 0.0).all() and is_shown(shape))
        return bool(coefficients[0] > 0.0 and (coefficients[1:] >= 0.0).all())

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return minus the force on the spring: as modelled, all that the drive gave, or what the load's mass needs."""
        run, row = view.run, view.row(site)
        if "ringing" in shape:
            pace = 2.0 * np.pi * shape["frequency"]
            shaken = np.gradient(run.velocity[:, [row]], run.period, axis=0) / pace**2
            swing = oscillator(-shaken, shape["frequency"], min(shape["damping"], MOST_DAMPED), run.period)
            return Signature({}, {Channel(self.stage, site): run.to_grid(swing)})
        if not shape.get("recorded") and "knee" not in shape:
            return super().signature(view, site, shape)
        pulls = parts(self._force(view, site, shape), shape)
        if "rubbed" in shape:
            pace = np.gradient(run.filtered(run.load)[:, row], run.period)
            pulls += [run.to_grid(x[:, None])[:, 0] for x in (np.sign(pace), pace)]
        return Signature({Channel(self.stage, site): column(*(-x for x in pulls))})

    def _force(self, view: AxisView, site: str, shape: Shape) -> Array:
        """Return the force (g,) on a spring that does not ring."""
        if shape.get("recorded"):
            return carried(view, site, shape["recorded"])
        return np.asarray(view.run.to_grid(needed(view, site, shape["load_mass"])))


def carried(view: AxisView, site: str, recorded: float) -> Array:
    """Return the force (g,) on a transmission: weight and known loads (0), as recorded (1), or of the load (2)."""
    run, row = view.run, view.row(site)
    if recorded == ComplianceOnAxis.OF_LOAD:
        bend = np.zeros(len(run.load))
        bend[1:-1] = np.diff(run.load[:, row], 2) / run.period**2
        return np.asarray(view.axis(site).load_mass * run.to_grid(bend[:, None])[:, 0] + view.path.gravity[:, row])
    if recorded:
        assert run.effort is not None
        return np.asarray(run.to_grid(run.effort)[:, row])
    return np.asarray(view.path.gravity[:, row] - view.path.contact_force[:, row])


class ComplianceOfJoint(TransmissionCompliance):
    """The same on a joint of a serial arm with a second encoder at its link: the force is what the link needs."""

    kinds = ("joint",)
    shapes = Page.shapes  # the rigid bodies tell the force
    units = SLOPES
    bent_from = BENT_FROM

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return forces at which the spring has a knee."""
        return knees((v.inertial[:, v.row(site)] for v in views), shape)

    def refine(self, shape: Shape) -> list[Shape]:
        """Return knees near this one; a straight spring has no neighbours."""
        return finer(shape) if "knee" in shape else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return minus the force that the link needs, or its parts up to the knee and beyond."""
        pulls = parts(view.inertial[:, view.row(site)], shape)
        return Signature({Channel(self.stage, site): column(*(-x for x in pulls))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return stiffness and compliance, and those beyond a knee: coefficients (1,), with a knee (2,)."""
        return {**super().parameters(shape, coefficients), **slopes(shape, coefficients)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether it is a spring, coefficients (1,), or (2,) on either side of a knee."""
        return bool((coefficients > 0.0).all() and is_shown(shape))


@dataclass(frozen=True)
class TransmissionComplianceInPlant(PlantEffect, page=TransmissionCompliance):
    """Screw, bearing or flexspline give way under what they carry: weight, contact, and the inertia of the load."""

    compliance: float = parameter("m/N", 1e-6, 0.0, 1e-4, "displacement of the load per force it carries")
    load_share: float = parameter("1", 0.0, 0.0, 0.95, "share of the axis' mass that the spring carries")
    frequency: float = parameter(
        "Hz", 0.0, 0.0, 100.0, "at which that mass swings; 0 where it swings too fast to be seen"
    )
    damping: float = parameter("1", 0.1, 0.0, 0.95, "share of critical damping of the swing")

    def apply(self, p: PlantParameters) -> None:
        """Soften the transmission and put a part of the mass behind it."""
        axis, rows = p.axis, self.rows
        axis["compliance"][rows] += self.compliance
        axis["load_mass"][rows] = self.load_share * axis["mass"][rows]
        axis["swing_frequency"][rows], axis["swing_damping"][rows] = self.frequency, self.damping
        if self.frequency:  # the spring is what the motor feels of it
            axis["mass"][rows] -= axis["load_mass"][rows]
