"""What a caller states in place of a guess: joints, controls, units, gains, delays, laws of servos."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from sher3_chain.manipulator.bodies import Bodies
from sher3_chain.manipulator.mjcf.drives import Drive, Driven, Step
from sher3_machines.intake.fields import TIME_UNITS
from sher3_machines.intake.units import UNITS, spelled

from sher3_public.errors import InputError
from sher3_public.records import Arrays

Gains = tuple[float, float]
Inertias = Literal["nominal", "identified"]
PLACES = ("m", "cm", "mm", "um", "nm", "rad", "mrad", "deg", "arcmin", "arcsec", "rev")
FORCES = ("N", "kN", "N*m", "mN*m")
TAKES: Mapping[str, Sequence[str]] = {
    "time": tuple(TIME_UNITS),
    "position": PLACES,
    "load": PLACES,
    "effort": FORCES,
    "control": (*PLACES, *FORCES),
}
"""Array -> units that it may be in."""


@dataclass(frozen=True)
class Stated:
    """What a caller states; what is left empty is guessed.

    Attributes:
        joints: names of the columns of `position`, in their order.
        gain: N m (N) per unit of the effort, one number or one for each joint by name, or `unknown`.
        resolution: one count of the encoders, rad or m.
        simulated: whether the effort is a simulator's own.
        units: array -> unit that it is in, where that is not SI.
        controls: joint, or actuator of the model, of each column of `control`.
        servo: stiffness and damping of the position servo on each joint, N m/rad and N m/(rad/s), or N/m and N/(m/s);
            one pair for all joints, or by name. They take the place of what the model says.
        delay: s after its stamp at which a control acts, beyond what the model says; for all joints, or by name.
        inertias: `nominal`: those of the model are compared with the robot; `identified`: found from the record.
    """

    joints: Sequence[str] = ()
    gain: float | str | Mapping[str, float | str] = 1.0
    resolution: float | None = None
    simulated: bool | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    controls: Sequence[str] = ()
    servo: Gains | Mapping[str, Gains] | None = None
    delay: float | Mapping[str, float] = 0.0
    inertias: Inertias = "nominal"

    def factors(self) -> dict[str, float]:
        """Return array -> factor to SI units; raises InputError for an array or a unit that is not known."""
        found = {}
        for name, unit in self.units.items():
            if name not in TAKES:
                raise InputError.unknown("units of no such array", name, TAKES)
            known = spelled(unit)
            if known not in TAKES[name]:
                raise InputError.unknown(f"unit of {name} is not known", unit, TAKES[name])
            found[name] = {**UNITS, **TIME_UNITS}[known]
        return found

    def in_si(self, run: Arrays) -> Arrays:
        """Return a run in SI units (s, m, rad, N, N m); raises InputError as `factors` does."""
        given = {name: (factor, getattr(run, name)) for name, factor in self.factors().items()}
        return replace(run, **{name: factor * x for name, (factor, x) in given.items() if x is not None})

    def drives(self, bodies: Bodies, names: Sequence[str], run: Arrays) -> Mapping[str, Driven]:
        """Return joint -> its drive: the model's, or the servo that is stated; raises InputError for a wrong name.

        A servo of firmware, without a model's, knows the speed of its last period alone, half of one ago.

        Args:
            bodies: of the model.
            names: of the recorded joints.
            run: of which the controls (n, m) and the stamps (n,) are looked at.
        """
        if self.servo is None:
            return bodies.drives
        gains = self.servo if isinstance(self.servo, Mapping) else dict.fromkeys(names, self.servo)
        _require_known("servo", gains, names)
        found = dict(bodies.drives)
        for name, (stiffness, damping) in gains.items():
            behind = Step(-0.5 * float(np.median(np.diff(run.time))) * float(damping))
            own = found.get(name) or Driven(bodies.joints[name], Step(), behind, 0.0, None, None)
            width = 0 if run.control is None else run.control.shape[1]
            number = own.drive.number if own.drive is not None and width != len(names) else list(names).index(name)
            limit, delay = (None, 0.0) if own.drive is None else (own.drive.limit, own.drive.delay)
            drive = Drive("as stated", number, 1.0, True, 1.0, float(stiffness), float(damping), limit, delay)
            found[name] = replace(own, drive=drive, reason="")
        return found

    def column(self, joint: str, drive: Drive | None) -> int | None:
        """Return the stated column of `control` that drives a joint; None: no column does."""
        own = [i for i, name in enumerate(self.controls) if name == joint or (drive and name == drive.name)]
        return own[0] if own else None

    def check_controls(self, width: int, names: Sequence[str], drives: Mapping[str, Driven]) -> None:
        """Raise InputError where the names of controls do not fit."""
        known = {*names, *drives, *(x.drive.name for x in drives.values() if x.drive is not None)}
        wrong = [name for name in self.controls if name not in known]
        if wrong or len(self.controls) != width or len(set(self.controls)) < len(self.controls):
            value = f"{len(self.controls)} names{f', {wrong[0]!r}' if wrong else ''}"
            limit = f"{width} columns, each another one of {', '.join(sorted(known))}"
            raise InputError("controls do not fit", value=value, limit=limit, remedy="name one for each column")

    def delayed(self, joint: dict[str, Any], guesses: list[str]) -> None:
        """Let the control of a joint act as late as stated; raises InputError for a delay below zero."""
        late = self.delay.get(joint["name"], 0.0) if isinstance(self.delay, Mapping) else self.delay
        signals = [joint["signals"][x] for x in ("reference", "command") if x in joint["signals"]]
        if not late or not signals:
            return
        if late < 0.0:
            raise InputError("delay is below zero", value=late, limit="0 s", remedy="give s after the stamp")
        signals[0]["late"] = signals[0].get("late", 0.0) + late
        guesses.append(f"{joint['name']}: its control acts {1e3 * late:.4g} ms late, as stated")

    def check_names(self, names: Sequence[str]) -> None:
        """Raise InputError where gains or delays are stated of joints that were not recorded."""
        for what, stated in (("gain", self.gain), ("delay", self.delay)):
            if isinstance(stated, Mapping):
                _require_known(what, stated, names)


def _require_known(what: str, stated: Mapping[str, object], names: Sequence[str]) -> None:
    wrong = [name for name in stated if name not in names]
    if wrong:
        remedy = "name joints that were recorded"
        raise InputError(f"{what} of no such joint", value=wrong[0], limit=", ".join(names), remedy=remedy)
