"""From tables to runs on a uniform clock in SI units, with the checks that refuse data no answer could rest on."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sher3_gap.channels import Array
from sher3_gap.machines.description import AxesMachine, Axis, Clock, Column
from sher3_gap.machines.errors import MachineError
from sher3_gap.machines.tables import Tables

MIN_SAMPLES = 100
JITTER = 0.01
"""Share of the period by which stamps may be off before the record is resampled."""
LONGEST_HOLE = 10.0
"""Periods without a sample that are interpolated over; a longer hole is refused."""
SLIPS = {"linear": (1e3, "mm recorded as m"), "rotary": (180.0 / np.pi, "deg recorded as rad")}
FURTHEST = {"linear": 10.0, "rotary": 40.0}
"""Travel (m, rad) beyond which an axis without a stated range is taken for a unit slip."""
SIGNALS = ("position", "reference", "command", "effort", "load")


@dataclass(frozen=True)
class AxesRun:
    """One record: uniform clock, `signals[axis][name]` (n,) in SI units."""

    name: str
    period: float
    signals: dict[str, dict[str, Array]]
    notes: list[str] = field(default_factory=list)


def axes_run(name: str, tables: Tables, machine: AxesMachine) -> AxesRun:
    """Bring one record onto a uniform clock.

    Raises:
        MachineError: a column is missing, values are not finite, stamps run backwards or have holes, a unit slips.
    """
    raw: dict[str, dict[str, tuple[Array | None, Array]]] = {}
    for axis in machine.axes:
        raw[axis.name] = {}
        for which in SIGNALS:
            column = getattr(axis.signals, which)
            if column is not None:
                raw[axis.name][which] = stamps_of(column, tables, machine.time, name), pick(column, tables, name)
    notes: list[str] = []
    clock, period = _clock([s for a in raw.values() for s in a.values()], machine.time, name, notes)
    signals = {a: {k: _onto(clock, t, x) for k, (t, x) in found.items()} for a, found in raw.items()}
    for axis in machine.axes:
        check_units(axis, signals[axis.name], name)
    return AxesRun(name, period, signals, notes)


def pick(column: Column, tables: Tables, run: str) -> Array:
    """Samples of a column in SI units, (n,) or (n, ...). Raises `MachineError` when missing, or not finite."""
    if column.column not in tables:
        have = ", ".join(sorted(tables)) or "none"
        raise MachineError(
            f"{run}: no column {column.column!r}", limit=f"columns: {have}", remedy="name it as the data do"
        )
    x = tables[column.column]
    if column.index is not None:
        if x.ndim < 2 or not 0 <= column.index < x.shape[1]:
            width = x.shape[1] if x.ndim > 1 else 1
            raise MachineError(
                f"{run}: {column.column} has no entry", value=column.index, limit=width, remedy="correct index"
            )
        x = x[:, column.index]
    bad = ~np.isfinite(x.reshape(len(x), -1)).all(axis=1)
    if bad.any():
        raise MachineError(
            f"{run}: {column.column} is not finite at sample {int(np.argmax(bad))}",
            value=f"{int(bad.sum())} of {len(x)} samples",
            remedy="cut the record before or after",
        )
    return x * column.scale


def stamps_of(column: Column, tables: Tables, clock: Clock, run: str) -> Array | None:
    """Stamps in s of the table a column is in; None where the clock is a rate."""
    if clock.column is None:
        return None
    table = column.column.rsplit("/", 1)[0] + "/" if "/" in column.column else ""
    name = table + clock.column if table + clock.column in tables else clock.column
    return pick(Column(column=name, unit=clock.unit), tables, run)


def _clock(found: list[tuple[Array | None, Array]], clock: Clock, run: str, notes: list[str]) -> tuple[Array, float]:
    lengths = {len(x) for _, x in found}
    if min(lengths) < MIN_SAMPLES:
        raise MachineError(
            f"{run}: too short", value=min(lengths), limit=f"{MIN_SAMPLES} samples", remedy="record longer"
        )
    if clock.rate is not None:
        if len(lengths) > 1:
            raise MachineError(f"{run}: columns differ in length", value=sorted(lengths), remedy="give a time column")
        return np.arange(min(lengths)) / clock.rate, 1.0 / clock.rate
    stamps = [t for t, _ in found if t is not None]
    for t, x in found:
        assert t is not None
        if len(t) != len(x):
            raise MachineError(
                f"{run}: time and signal differ in length", value=len(x), limit=len(t), remedy="check columns"
            )
        _check_stamps(t, run)
    period = float(np.median(np.diff(stamps[0])))
    start, end = max(t[0] for t in stamps), min(t[-1] for t in stamps)
    if end - start < MIN_SAMPLES * period:
        raise MachineError(
            f"{run}: the signals hardly overlap", value=f"{end - start:.3g} s", remedy="check the time unit"
        )
    uneven = max(float(np.max(np.abs(np.diff(t) - period))) for t in stamps)
    if uneven > JITTER * period:
        notes.append(
            f"{run}: stamps are off the grid by up to {uneven / period:.2g} periods; resampled every {period:.4g} s"
        )
    return start + period * np.arange(int((end - start) / period + 1e-6) + 1), period


def _check_stamps(t: Array, run: str) -> None:
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


def _onto(clock: Array, t: Array | None, x: Array) -> Array:
    return np.asarray(x if t is None else np.interp(clock, t, x), dtype=float)


def check_units(axis: Axis, signals: dict[str, Array], run: str) -> None:
    """Find positions recorded in another unit than stated: out of range, or 1000 or 57.3 times off each other."""
    position = signals["position"]
    lowest, highest = axis.range or (-FURTHEST[axis.motion], FURTHEST[axis.motion])
    worst = float(position[np.argmax(np.abs(position))])
    span = max(abs(lowest), abs(highest))
    if not lowest - 0.1 * span <= worst <= highest + 0.1 * span:
        ratio, slip = SLIPS[axis.motion]
        likely = f"; likely {slip}" if abs(worst) / ratio <= 1.1 * span else ""
        raise MachineError(
            f"{run}: {axis.name}.position leaves the range of the axis{likely}",
            value=f"{worst:.4g}",
            limit=f"{lowest:g} .. {highest:g}",
            remedy="correct the unit in the description, or state the axis' range",
        )
    for other in ("reference", "load"):
        if other in signals and np.ptp(signals[other]) > 0.0 and np.ptp(position) > 100.0 * axis.encoder_resolution:
            ratio = float(np.ptp(signals[other]) / np.ptp(position))
            factor, slip = SLIPS[axis.motion]
            if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(1.25):
                larger = other if ratio > 1.0 else "position"
                raise MachineError(
                    f"{run}: {axis.name}.{larger}: likely {slip}",
                    value=f"{other} spans {ratio:.4g} times the position",
                    limit="1",
                    remedy="correct the units in the description",
                )
