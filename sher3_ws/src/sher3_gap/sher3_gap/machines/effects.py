"""The library's effects on a machine's axes, and the three that a position servo shows in its tracking error."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.signal import lfilter

from sher3_gap.attribute import Candidates
from sher3_gap.channels import Array, Channel
from sher3_gap.fitting import Fit, Term
from sher3_gap.library import LIBRARY, LibraryEffect, Shape, Signature, View
from sher3_gap.library.base import column
from sher3_gap.library.operators import play
from sher3_gap.machines.axis_view import SEEN_AS
from sher3_gap.machines.description import Axis

BALANCE = (
    "coulomb_friction",
    "stribeck_friction",
    "viscous_friction",
    "presliding_friction",
    "gravity_load",
    "torque_constant",
)
"""Effects on the force balance of any axis."""
DRY = ("coulomb_friction", "stribeck_friction", "presliding_friction")
"""Frictions that hold an axis at rest."""
PERIODIC = ("cogging", "position_friction")
"""Those that need the travel per motor revolution."""
LINK = (
    "lead_error",
    "backlash",
    "transmission_compliance",
    "transmission_hysteresis",
    "transmission_ripple",
    "encoder_eccentricity",
)
"""Those between two encoders."""
MOVES = 0.45
"""Share of the reference's stroke that stiction may hold: an axis that never breaks loose tells nothing of it."""
ROTARY_SITE = "roll"
"""SHER's rotary actuator: the library gives its units for it."""


def lagged(x: Array, time_constant: float, period: float) -> Array:
    """First-order lag of x (n, 1), exact for a held input, at rest at first."""
    keep = float(np.exp(-period / time_constant))
    return np.asarray(lfilter([0.0, 1.0 - keep], [1.0, -keep], x - x[0], axis=0) + x[0])


class ServoLag(LibraryEffect):
    """A servo that follows its reference like a first-order filter: error = reference - filtered reference."""

    id, family, stage = "drive_lag", "timing", "drive"
    explanation = "The axis follows its reference late, like a first-order filter."
    units = {"time_constant": "s"}
    PERIODS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Time constants in periods of the record."""
        return [{"time_constant": n * views[0].run.period} for n in self.PERIODS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{"time_constant": shape["time_constant"] * f} for f in (0.8, 0.9, 0.95, 1.05, 1.1, 1.25)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient."""
        assert view.run.reference is not None
        late = lagged(view.run.reference, shape["time_constant"], view.run.period)
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(view.run.reference - late)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Time constant."""
        return {"time_constant": shape["time_constant"]}


class ServoDelay(LibraryEffect):
    """A servo that follows its reference a dead time late."""

    id, family, stage = "command_delay", "timing", "transport"
    explanation = "The axis follows its reference a fixed time late."
    units = {"delay": "s"}
    PERIODS = ServoLag.PERIODS

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Dead times in periods of the record."""
        return [{"delay": n * views[0].run.period} for n in self.PERIODS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{"delay": shape["delay"] * f} for f in (0.8, 0.9, 0.95, 1.05, 1.1, 1.25)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient."""
        assert view.run.reference is not None
        clock, reference = view.run.stage_clock, view.run.reference
        late = np.interp(clock - shape["delay"], clock, reference[:, 0])
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(reference - late[:, None])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Dead time."""
        return {"delay": shape["delay"]}


class AxisMass(LibraryEffect):
    """Mass on one axis that the description does not know: F = mass * a."""

    id, family, stage = "payload_mass", "inertia", "motor_mechanics"
    explanation = LIBRARY["payload_mass"].explanation
    units = {"mass": "kg"}

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the acceleration."""
        return Signature({Channel(self.stage, site): column(view.run.to_grid(view.run.acceleration)[:, 0])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Extra mass, or inertia."""
        return {"mass": float(coefficients[0])}

    def unit(self, name: str, site: str) -> str:
        """Inertia on a rotary axis."""
        return "kg*m^2" if site == ROTARY_SITE else "kg"


class ServoStiction(LibraryEffect):
    """Coulomb friction under a proportional servo: the axis stays until the error reaches friction over stiffness.

    The position is the reference after a play of +-force, force in units of the servo's stiffness (rad or m of error).
    """

    id, family, stage = "coulomb_friction", "friction", "motor_mechanics"
    explanation = (
        "The axis does not answer small changes of its reference: it stays until the error is large enough to break it "
        "loose."
    )
    units = {"force": "m", "late": "s"}
    SHARES = (0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.45)
    LATE = (0.0, 2.0, 4.0)
    """Lag of what the friction sees, in periods of the record: a servo is late before it sticks."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Half widths as shares of the span of the error."""
        errors = np.concatenate([(v.run.reference - v.run.motor)[:, 0] for v in views if v.run.reference is not None])
        span = float(np.ptp(np.percentile(errors, [0.5, 99.5])))
        late = [n * views[0].run.period for n in self.LATE]
        stroke = max(float(np.ptp(v.run.reference)) for v in views if v.run.reference is not None)
        forces = [s * span for s in self.SHARES if 0.0 < s * span < MOVES * stroke]
        return [{"force": f, "late": t} for f in forces for t in late]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        near: list[Shape] = [{**shape, "force": shape["force"] * f} for f in (0.7, 0.85, 0.93, 1.07, 1.15, 1.3)]
        return [*near, *({**shape, "late": shape["late"] * f} for f in (0.6, 0.8, 1.25, 1.6) if shape["late"])]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient."""
        assert view.run.reference is not None
        x = view.run.reference
        x = (lagged(x, shape["late"], view.run.period) if shape["late"] else x)[:, 0]
        behind = play(x, np.zeros_like(x), 2.0 * shape["force"], np.inf, view.run.period, 0.0)
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(-behind)[:, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Friction over stiffness, and how late the servo is before it sticks."""
        return {"force": shape["force"], **({"late": shape["late"]} if shape["late"] else {})}


SERVO: Mapping[str, LibraryEffect] = {
    e.id: e for e in (ServoLag(), ServoDelay(), ServoStiction(), LIBRARY["gravity_load"])
}
"""What a position servo can show when its force is not recorded."""


class MachineEffect(LibraryEffect):
    """An effect of the library on one axis of a machine, under the axis' name."""

    def __init__(self, base: LibraryEffect, axis: Axis) -> None:
        self.base, self.axis = base, axis
        self.id, self.family, self.stage = base.id, base.family, base.stage  # type: ignore[misc]
        self.extends, self.explanation = base.extends, base.explanation  # type: ignore[misc]
        self._seen: dict[tuple, Signature] = {}

    def sites(self) -> tuple[str, ...]:
        """The axis."""
        return (self.axis.name,)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """The base's channels; a servo has one, its tracking error."""
        return tuple(dict.fromkeys(self._own(c) for c in self.base.channels(SEEN_AS)))

    def _own(self, channel: Channel) -> Channel:
        stage = "motor_mechanics" if self.axis.command_law.kind == "position" else channel.stage
        return Channel(stage, self.axis.name)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """The base's; a constant weight alone where the nominal has none."""
        shapes = self.base.shapes(views, SEEN_AS)
        if self.id == "gravity_load" and not any(v.path.gravity.any() for v in views):
            shapes = [s for s in shapes if s["constant"]]
        return shapes

    def refine(self, shape: Shape) -> list[Shape]:
        """The base's."""
        return self.base.refine(shape)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """The base's, under the axis' name; blocks of one record share it."""
        key = (id(view), tuple(sorted(shape.items())))
        if key not in self._seen:
            raw = self.base.signature(view, SEEN_AS, shape)
            self._seen[key] = Signature(
                {self._own(c): x for c, x in raw.columns.items()}, {self._own(c): x for c, x in raw.fixed.items()}
            )
        return self._seen[key]

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """The base's."""
        return self.base.parameters(shape, coefficients)

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """The base's."""
        return self.base.admissible(shape, coefficients)

    def unit(self, name: str, site: str) -> str:
        """The base's; forces of a servo are in units of its stiffness."""
        rotary = self.axis.motion == "rotary"
        unit = self.base.unit(name, ROTARY_SITE if rotary else SEEN_AS)
        servo = self.axis.command_law.kind == "position"
        return ("rad" if rotary else "m") if servo and unit in ("N", "N*m") else unit


def effects_on(axis: Axis, without: Collection[str]) -> list[LibraryEffect]:
    """Effects that can show in what was recorded of an axis."""
    if axis.command_law.kind == "position":
        found = dict(SERVO)
    else:
        names = BALANCE + (PERIODIC if axis.lead else ())
        found = {n: LIBRARY[n] for n in names}
        if axis.mass != "unknown":
            found["payload_mass"] = AxisMass()
        if axis.command_law.kind == "none":
            del found["torque_constant"]
    if axis.signals.load is not None:
        found |= {n: LIBRARY[n] for n in LINK if axis.lead or n in ("lead_error", "backlash")}
    return [MachineEffect(e, axis) for n, e in sorted(found.items()) if n not in without]


@dataclass
class MachineCandidates(Candidates):
    """Candidates from a list of effects; with `dry_first` a friction that holds an axis at rest comes first."""

    listed: list[LibraryEffect] = field(default_factory=list)
    dry_first: bool = False

    def effects(self) -> list[LibraryEffect]:
        """The effects listed."""
        return self.listed

    def search(self, channels: Collection[Channel], given: Sequence[Term] = ()) -> list[Fit]:
        """As the engine's; of the first cause only dry frictions where they are asked for."""
        found = super().search(channels, given)
        if self.dry_first and not any(t.effect.id in DRY for t in given):
            found = [f for f in found if f.terms[-1].effect.id in DRY]
        return found


def polished(candidates: MachineCandidates, found: Fit) -> Fit:
    """Search the shape of every term again beside the others: forward selection chose it before they were there."""
    for _ in range(2):
        for term in list(found.terms):
            others = [t for t in found.terms if t is not term]
            trial = candidates.best(term.effect, term.site, others)
            if trial is not None and trial.total < found.total:
                found = trial
    return found
