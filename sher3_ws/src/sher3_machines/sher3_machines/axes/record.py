"""From tables to runs on a uniform clock in SI units, with the checks that refuse data no answer could rest on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.axes.description import Axis
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick, stamps_of
from sher3_machines.intake.fields import Clock
from sher3_machines.intake.tables import Tables

MIN_SAMPLES = 100
"""Samples a run must have: the blocks that take the place of repeats need a dozen each."""
JITTER = 0.01
"""Share of the period by which stamps may be off before the record is resampled."""
LONGEST_HOLE = 10.0
"""Periods without a sample that are interpolated over; a longer hole is refused."""
SLIPS = {"linear": (1e3, "mm recorded as m"), "rotary": (180.0 / np.pi, "deg recorded as rad")}
"""Motion -> factor of its usual wrong unit, and that slip in words."""
SLIP_TOLERANCE = 1.25
"""Factor within which a ratio of two signals counts as that of a wrong unit."""
FURTHEST = {"linear": 10.0, "rotary": 40.0}
"""Travel, m or rad, beyond which an axis without a stated range is taken for a unit slip."""
BEYOND = 0.1
"""Share of the range by which a position may leave it: stated ranges are rounded."""
COUNTS_MOVED = 100.0
"""Travel in counts from which two signals of one axis can be compared in size."""
SIGNALS = ("position", "reference", "command", "effort", "load", "nominal_effort", "applied")
"""Signals of an axis, as the description names them."""

POSITIONS = ("position", "reference", "load")
"""Signals that are places."""
WRAP = 0.1
"""Share of a turn by which a jump between two samples may differ from a whole turn that was wrapped."""

Stamped = tuple[Array | None, Array]
"""Stamps in s, where there are any, and the samples."""


@dataclass(frozen=True)
class AxesRun:
    """One record on a uniform clock, SI units.

    Attributes:
        name: of its file.
        period: of the samples, s.
        signals: axis -> signal -> (n,).
        notes: what was done to the data.
    """

    name: str
    period: float
    signals: dict[str, dict[str, Array]]
    notes: Sequence[str] = ()


class Chain(Protocol):
    """What the description of a machine says of the axes that were recorded."""

    @property
    def time(self) -> Clock:
        """The clock of the samples."""

    @property
    def axes(self) -> Sequence[Axis]:
        """Every axis, with its signals."""


def axes_run(name: str, tables: Tables, machine: Chain) -> AxesRun:
    """Bring one record onto a uniform clock.

    Raises:
        MachineError: a column is missing, values are not finite, stamps run backwards or have holes, a unit slips.
    """
    raw: dict[str, dict[str, Stamped]] = {}
    for axis in machine.axes:
        columns = {which: getattr(axis.signals, which) for which in SIGNALS}
        raw[axis.name] = {
            which: (stamps_of(column, tables, machine.time, name), pick(column, tables, name))
            for which, column in columns.items()
            if column is not None
        }
    unwrapped = [note for axis in machine.axes for note in _unwrap(axis, raw[axis.name], name)]
    clock, period, notes = _clock([s for a in raw.values() for s in a.values()], machine.time, name)
    signals = {a: {k: _onto(clock, t, x) for k, (t, x) in found.items()} for a, found in raw.items()}
    for axis in machine.axes:
        check_units(axis, signals[axis.name], name)
    return AxesRun(name, period, signals, [*unwrapped, *notes])


def _unwrap(axis: Axis, raw: dict[str, Stamped], run: str) -> list[str]:
    """Join the turns of angles that were recorded within one turn; return a note for each such signal."""
    notes = []
    for which in POSITIONS if axis.motion == "rotary" else ():
        if which in raw:
            stamps, x = raw[which]
            jumps = np.abs(np.abs(np.diff(x)) - 2.0 * np.pi) < WRAP * 2.0 * np.pi
            if jumps.any():
                raw[which] = stamps, np.unwrap(x)
                notes.append(f"{run}: {axis.name}.{which} wraps {int(jumps.sum())} times within a turn; turns joined")
    return notes


def _clock(found: list[Stamped], clock: Clock, run: str) -> tuple[Array, float, list[str]]:
    """The uniform clock (n,) of all signals, its period, and a note where stamps are off it."""
    lengths = {len(x) for _, x in found}
    if min(lengths) < MIN_SAMPLES:
        raise MachineError(
            f"{run}: too short", value=min(lengths), limit=f"{MIN_SAMPLES} samples", remedy="record longer"
        )
    if clock.rate is not None:
        if len(lengths) > 1:
            raise MachineError(f"{run}: columns differ in length", value=sorted(lengths), remedy="give a time column")
        return np.arange(min(lengths)) / clock.rate, 1.0 / clock.rate, []
    stamps = [_checked(t, x, run) for t, x in found if t is not None]
    period = float(np.median(np.diff(stamps[0])))
    start, end = max(t[0] for t in stamps), min(t[-1] for t in stamps)
    if end - start < MIN_SAMPLES * period:
        raise MachineError(
            f"{run}: the signals hardly overlap",
            value=f"{end - start:.3g} s",
            remedy="check the time unit, or state `offsets` of the clock",
        )
    uneven = max(float(np.max(np.abs(np.diff(t) - period))) for t in stamps) / period
    note = f"{run}: stamps are off the grid by up to {uneven:.2g} periods; resampled every {period:.4g} s"
    samples = int((end - start) / period + 1e-6) + 1  # the last stamp counts though rounding may put it just before
    return start + period * np.arange(samples), period, [note] if uneven > JITTER else []


def _checked(t: Array, x: Array, run: str) -> Array:
    """Stamps (n,) of samples, refused where they run backwards, have a hole or are not as many as the samples."""
    if len(t) != len(x):
        raise MachineError(
            f"{run}: time and signal differ in length", value=len(x), limit=len(t), remedy="check columns"
        )
    steps = np.diff(t)
    if (steps <= 0.0).any():
        at = int(np.argmax(steps <= 0.0)) + 1
        raise MachineError(
            f"{run}: time does not increase at sample {at}",
            value=f"{steps[at - 1]:.3g} s",
            remedy="cut the record there",
        )
    hole = float(steps.max() / np.median(steps))
    if hole > LONGEST_HOLE:
        at = int(np.argmax(steps)) + 1
        raise MachineError(
            f"{run}: a hole of {steps[at - 1]:.3g} s before sample {at}",
            value=f"{hole:.0f} periods",
            limit=f"{LONGEST_HOLE:.0f} periods",
            remedy="import the parts as runs of their own",
        )
    return t


def _onto(clock: Array, t: Array | None, x: Array) -> Array:
    """Samples interpolated to the clock (n,); those without stamps are on it."""
    return np.asarray(x if t is None else np.interp(clock, t, x), dtype=float)


def check_units(axis: Axis, signals: dict[str, Array], run: str) -> None:
    """Refuse positions recorded in another unit than stated.

    They leave the axis' range, or are 1000 (mm for m) or 57.3 (deg for rad) times another position of the axis.

    Raises:
        MachineError: a unit slips.
    """
    position = signals["position"]
    _check_range(axis, position, run)
    moves = np.ptp(position) > COUNTS_MOVED * axis.encoder_resolution
    for other in ("reference", "load"):
        if moves and other in signals and np.ptp(signals[other]) > 0.0:
            ratio = float(np.ptp(signals[other]) / np.ptp(position))
            factor, slip = SLIPS[axis.motion]
            if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(SLIP_TOLERANCE):
                larger = other if ratio > 1.0 else "position"
                raise MachineError(
                    f"{run}: {axis.name}.{larger}: likely {slip}",
                    value=f"{other} spans {ratio:.4g} times the position",
                    limit="1",
                    remedy="correct the units in the description",
                )


def _check_range(axis: Axis, position: Array, run: str) -> None:
    lowest, highest = axis.range or (-FURTHEST[axis.motion], FURTHEST[axis.motion])
    worst = float(position[np.argmax(np.abs(position))])
    span = max(abs(lowest), abs(highest))
    if lowest - BEYOND * span <= worst <= highest + BEYOND * span:
        return
    factor, slip = SLIPS[axis.motion]
    likely = f"; likely {slip}" if abs(worst) / factor <= (1.0 + BEYOND) * span else ""
    raise MachineError(
        f"{run}: {axis.name}.position leaves the range of the axis{likely}",
        value=f"{worst:.4g}",
        limit=f"{lowest:g} .. {highest:g}",
        remedy="correct the unit in the description, or state the axis' range",
    )
