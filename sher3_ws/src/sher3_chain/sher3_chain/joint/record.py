"""From tables to runs on a uniform clock in SI units, with the checks that refuse data no answer could rest on."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from sher3_diagnosis.channel import Array, Mask
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import MOTION, clock_beside, find, pick, stamps_of
from sher3_machines.intake.fields import Clock, Column
from sher3_machines.intake.mending.motion import check_speed, counts_backwards, is_magnitude, signs_of, speed_ratio
from sher3_machines.intake.mending.parts import LONGEST_HOLE
from sher3_machines.intake.mending.readings import glitches, known_readings, stays
from sher3_machines.intake.mending.repeats import (
    LONGEST_HOLD,
    filled,
    fresh_readings,
    fresh_rows,
    goes_smoothly,
    hold_of,
)
from sher3_machines.intake.mending.stamps import even_stamps, missed_periods, missing_note
from sher3_machines.intake.mending.wraps import TURN, joined, wrapped_over
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables

from sher3_chain.joint.description import Axis, ChainDescription
from sher3_chain.joint.logged import in_time, integrated, is_speed, with_counted_clock, with_signs
from sher3_chain.joint.moments import JITTER, Stamped, timed
from sher3_chain.joint.units import check_units

MIN_SAMPLES = 20
"""Samples a run must have: five blocks of the smallest size. Several short runs are judged together."""
ROUNDING = 1e-6
"""Share by which a period may be off through rounding."""
STILL = 1e-3
"""Share of its span by which a signal moves across a hole at most that nobody posted a change in."""
SIGNALS = ("position", "reference", "command", "effort", "load", "nominal_effort", "applied", "temperature")
"""Signals of an axis, as the description names them."""

POSITIONS = ("position", "reference", "load")
"""Signals that are places."""
ENCODERS = ("position", "load")
"""Signals that an encoder reads: nothing moves in steps."""
READINGS = (*ENCODERS, "effort")
"""Signals that are measured: a value that stays is an old one. A command may well be held, and a reference that goes in
steps.
"""
TOLD = ("reference", "command", "effort")
"""Signals that a log may have a reading of where they change alone."""
OTHERS = ("reference", "load")
"""Places that follow the position, in its sense or turned."""


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

    @property
    def ticks(self) -> int:
        """Number of samples; every signal has as many."""
        return next((len(x) for found in self.signals.values() for x in found.values()), 0)

    def without(self, joint: str, signals: Collection[str]) -> AxesRun:
        """Return the run without some signals of a joint."""
        kept = {k: x for k, x in self.signals[joint].items() if k not in signals}
        return replace(self, signals={**self.signals, joint: kept})


def axes_run(name: str, tables: Tables, machine: ChainDescription) -> AxesRun:
    """Bring one record onto a uniform clock.

    Raises:
        MachineError: a column is missing, values are not finite, stamps run backwards or have holes, a unit slips.
    """
    raw: dict[str, dict[str, Stamped]] = {}
    over: dict[str, float] = {}
    tables, signs = with_signs(tables, machine, name)
    tables, counted = with_counted_clock(tables, machine, name)
    tables, mended = _without_repeats(tables, machine, name)
    mended = counted + mended
    polled = bool(mended)
    mended += signs
    for axis in machine.chain:
        raw[axis.name] = {
            which: _mended(
                column, tables, machine.time, name, (axis.name, which), mended, axis.command_law.loop is not None
            )
            for which, column in _columns(axis).items()
        }
        summed = {which for which, column in _columns(axis).items() if is_speed(column, tables, name)}
        over[axis.name], joints = _unwrap(axis, raw[axis.name], name, summed)
        mended += joints
        mended += _without_glitches(axis, raw[axis.name], name)
        _check_velocity(axis, raw[axis.name]["position"], tables, machine.time, name)
    mended += timed(raw, name)
    clock, period, notes = _clock([s for a in raw.values() for s in a.values()], machine.time, name, polled)
    signals = {
        a: {k: _onto(clock, t, x, polled and k in ENCODERS) for k, (t, x) in found.items()} for a, found in raw.items()
    }
    for axis in machine.chain:
        check_units(axis, signals[axis.name], name, over[axis.name])
        mended += _turned(axis, signals[axis.name], name)
        mended += _signed(axis, clock, signals[axis.name], name)
    return AxesRun(name, period, signals, [*dict.fromkeys(mended), *notes])


def _mended(
    column: Column, tables: Tables, clock: Clock, run: str, of: tuple[str, str], notes: list[str], steps: bool = False
) -> Stamped:
    """Return the readings of a column with their stamps, without those that are missing or written twice.

    A reference in `steps` is one that its drive takes as it is.
    """
    stamps, x = stamps_of(column, tables, clock, run), pick(column, tables, run, finite=False)
    what = f"{run}: {of[0]}.{of[1]} ({column.column})"
    if x.ndim != 1:
        raise MachineError(f"{what} is a list at each sample", value=x.shape, limit="1 number", remedy="give `index`")
    if stamps is not None:
        if len(stamps) != len(x):
            raise MachineError(
                f"{what}: time and signal differ in length", value=len(x), limit=len(stamps), remedy="check columns"
            )
        stamps, keep, note = even_stamps(stamps, run)
        x = x[keep]
        notes += [note] if note else []
    if stamps is not None and of[1] in TOLD and 0 < np.isfinite(x).sum() < MIN_SAMPLES < len(x):
        notes.append(f"{what}: posted {np.isfinite(x).sum()} times; what was told stays until it is told anew")
        x = stays(x)
        known = np.isfinite(x)
    else:
        known, note = known_readings(x, stamps is not None, what)
        notes += [note] if note else []
    stamps, x = _only(stamps, x, known)
    may_be_held = of[1] in READINGS or (of[1] == "reference" and not steps)
    fresh = fresh_readings(x, steps=of[1] not in ENCODERS) if may_be_held else np.ones(len(x), dtype=bool)
    if not fresh.all() and (of[1] in READINGS or goes_smoothly(x[fresh])):
        stamps, x = _only(stamps, x, fresh)
        notes.append(f"{what} is held for {hold_of(fresh):.0f} rows: slower than the log; its new readings are taken")
    if of[1] in POSITIONS and is_speed(column, tables, run):
        in_time(x, what)
        x = integrated(stamps, x, clock)
        notes.append(f"{what} is a velocity; integrated, so that places count from the first sample")
    return _late(stamps, x, column.late, clock)


def _late(stamps: Array | None, x: Array, late: float, clock: Clock) -> Stamped:
    """Return samples as they act, some time after their stamps; without stamps by whole samples."""
    if stamps is not None:
        return stamps + late, x
    samples = round(late * (clock.rate or 0.0))
    return stamps, np.concatenate([np.full(samples, x[0]), x])[: len(x)]


def _without_repeats(tables: Tables, machine: ChainDescription, run: str) -> tuple[Tables, list[str]]:
    """Return the tables without the rows that repeat their predecessor in all described columns, and a note for each.

    Tables of one clock are one log, parted by signal. Where the clock is a rate each row has its place: those rows are
    interpolated.
    """
    logs: dict[str, set[str]] = {}
    for column in (c for axis in machine.chain for c in _columns(axis).values()):
        home = table_of(column.column)
        clock = clock_beside(home, tables, machine.time, run)
        logs.setdefault(home if clock is None else clock, set()).add(find(column.column, tables, run))
    out, notes = dict(tables), []
    for clock, named in sorted(logs.items()):
        own = [tables[c] for c in named if len(tables[c])]
        if len({len(x) for x in own}) != 1 or any(not np.issubdtype(x.dtype, np.number) for x in own):
            continue
        fresh = fresh_rows(own)
        if fresh.all():
            continue
        homes = {table_of(c) for c in (*named, clock)}
        rows = [c for c, x in tables.items() if table_of(c) in homes and x.ndim and len(x) == len(fresh)]
        timed = machine.time.column is not None
        out |= {c: tables[c][fresh] if timed else filled(tables[c], fresh) for c in rows if timed or c in named}
        lost = int((~fresh).sum())
        notes.append(
            f"{run}: {lost} of {len(fresh)} rows repeat the row before in every column: polled twice; "
            f"{'left out' if timed else 'interpolated'}"
        )
    return out, notes


def _columns(axis: Axis) -> dict[str, Column]:
    """Return the recorded signals of an axis."""
    found = {which: getattr(axis.signals, which) for which in SIGNALS}
    return {which: column for which, column in found.items() if column is not None}


def _turned(axis: Axis, signals: dict[str, Array], run: str) -> list[str]:
    """Turn places that count against the position; return a note for each."""
    notes = []
    for which in OTHERS:
        if which in signals and counts_backwards(signals[which], signals["position"]):
            signals[which] = -signals[which]
            notes.append(f"{run}: {axis.name}.{which} counts against the position; turned")
    return notes


def _only(stamps: Array | None, x: Array, kept: Mask) -> Stamped:
    """Return the readings that are kept; without stamps the others are interpolated, since each has its place."""
    if stamps is not None:
        return stamps[kept], x[kept]
    place = np.arange(len(x))
    return None, np.interp(place, place[kept], x[kept])


def _without_glitches(axis: Axis, raw: dict[str, Stamped], run: str) -> list[str]:
    """Leave impossible readings out; return a note for each signal that had some."""
    notes = []
    for which in READINGS:
        if which in raw:
            stamps, x = raw[which]
            bad = glitches(x)
            if len(bad):
                kept = np.ones(len(x), dtype=bool)
                kept[bad] = False
                raw[which] = _only(stamps, x, kept)
                worst = float(x[bad[int(np.argmax(np.abs(x[bad])))]])
                unit = ("N m" if axis.motion == "rotary" else "N") if which == "effort" else axis.unit_of_position
                notes.append(
                    f"{run}: {axis.name}.{which}: {len(bad)} readings are far off those beside them, such as "
                    f"{worst:.4g} {unit}; interpolated"
                )
    return notes


def _unwrap(axis: Axis, raw: dict[str, Stamped], run: str, summed: Collection[str]) -> tuple[float, list[str]]:
    """Join places whose counter starts again; return the range of the position's, 0 for none, and a note for each.

    A reference that jumps back may have been told to: it is joined over the range of the encoder that follows it.
    What is `summed` from a speed has no counter.
    """
    notes, rotary = [], axis.motion == "rotary"
    places = [which for which in POSITIONS if which in raw and which not in summed]
    over = {which: wrapped_over(raw[which][1], axis.encoder_resolution, rotary) for which in places}
    if "position" not in over:
        return 0.0, []
    if over.get("reference") != TURN:
        over["reference"] = over["position"]
    for which in raw.keys() & over.keys():
        stamps, x = raw[which]
        x, wraps = joined(x, over[which]) if over[which] else (x, 0)
        if wraps:
            raw[which] = stamps, x
            within = "a turn" if over[which] == TURN else f"{over[which]:.6g} {axis.unit_of_position}"
            notes.append(f"{run}: {axis.name}.{which} wraps {wraps} times within {within}; joined")
    return over["position"], sorted(notes)


def _check_velocity(axis: Axis, position: Stamped, tables: Tables, clock: Clock, run: str) -> None:
    """Refuse a clock or a unit that the recorded velocity of an axis contradicts; raises MachineError."""
    if (column := axis.signals.velocity) is None:
        return
    what = f"{run}: {axis.name}.velocity ({column.column})"
    stamps, v = _mended(column, tables, clock, run, (axis.name, "velocity"), [])
    t, x = position
    if t is None or stamps is None:
        t = stamps = np.arange(len(x)) / (clock.rate or 1.0)
    check_speed(speed_ratio(t, x, np.interp(t, stamps, v)), clock.unit if clock.rate is None else None, what)


def _signed(axis: Axis, clock: Array, signals: dict[str, Array], run: str) -> list[str]:
    """Give an effort that is a magnitude the sign of the motion; return a note that says so."""
    column = axis.signals.effort
    if column is None:
        return []
    x, effort = signals["position"], signals["effort"]
    stated = column.signed_by == MOTION
    if not stated and (column.signed_by is not None or not is_magnitude(clock, x, effort)):
        return []
    signals["effort"] = np.abs(effort) * signs_of(clock, x)
    why = "as the description says" if stated else "because it is never below zero and clearer so"
    return [f"{run}: {axis.name}.effort ({column.column}) has the sign of the motion, {why}"]


def _clock(found: list[Stamped], clock: Clock, run: str, polled: bool) -> tuple[Array, float, list[str]]:
    """The uniform clock (n,) of all signals, its period, and a note where stamps are off it.

    Rows of a `polled` log that were left out are no periods that its clock missed.
    """
    lengths = {len(x) for _, x in found}
    if min(lengths) < MIN_SAMPLES:
        raise MachineError(
            f"{run}: too short", value=min(lengths), limit=f"{MIN_SAMPLES} samples", remedy="record longer"
        )
    if clock.rate is not None:
        if len(lengths) > 1:
            raise MachineError(f"{run}: columns differ in length", value=sorted(lengths), remedy="give a time column")
        return np.arange(min(lengths)) / clock.rate, 1.0 / clock.rate, []
    longest = LONGEST_HOLE + (LONGEST_HOLD if polled else 0.0)  # rows that were left out, and a row that is late
    stamps = [_checked(t, x, run, longest) for t, x in found if t is not None]
    period = float(max(np.median(np.diff(t)) for t in stamps))  # of the slowest signal: between its samples is nothing
    start, end = max(t[0] for t in stamps), min(t[-1] for t in stamps)
    if end - start < (MIN_SAMPLES - 1) * period * (1.0 - ROUNDING):
        raise MachineError(
            f"{run}: the signals hardly overlap",
            value=f"{end - start:.3g} s",
            remedy="check the time unit, or state `offsets` of the clock",
        )
    missed = max((missed_periods(t) for t in stamps), key=lambda x: int(x.sum()))
    notes = [missing_note(missed, period, run)] if len(missed) and not polled else []
    uneven = max(float(np.max(np.abs(np.diff(t) - period))) for t in stamps) / period
    note = f"{run}: stamps are off the grid by up to {uneven:.2g} periods; resampled every {period:.4g} s"
    samples = int((end - start) / period + 1e-6) + 1  # the last stamp counts though rounding may put it just before
    return start + period * np.arange(samples), period, notes + ([note] if uneven > JITTER else [])


def _checked(t: Array, x: Array, run: str, longest: float) -> Array:
    """Stamps (n,), refused where they run backwards or have a hole of more periods than the longest.

    A hole in which a signal (n,) did not move is none: monitors of a control system post what changes.
    """
    steps = np.diff(t)
    if (steps <= 0.0).any():
        at = int(np.argmax(steps <= 0.0)) + 1
        raise MachineError(
            f"{run}: time does not increase at sample {at}",
            value=f"{steps[at - 1]:.3g} s",
            remedy="cut the record there",
        )
    unseen = np.where(np.abs(np.diff(x)) > STILL * float(np.ptp(x)), steps, 0.0)
    hole = float(unseen.max() / np.median(steps))
    if hole > longest:
        at = int(np.argmax(unseen)) + 1
        raise MachineError(
            f"{run}: a hole of {steps[at - 1]:.3g} s before sample {at}",
            value=f"{hole:.0f} periods",
            limit=f"{longest:.0f} periods",
            remedy="import the parts as runs of their own",
        )
    return t


def _onto(clock: Array, t: Array | None, x: Array, smooth: bool) -> Array:
    """Samples interpolated to the clock (n,), by a spline where they are `smooth`; those without stamps are on it."""
    if t is None:
        return np.asarray(x, dtype=float)
    return np.asarray(CubicSpline(t, x)(clock) if smooth else np.interp(clock, t, x), dtype=float)
