"""A description drafted from a file: what each column seems to be, and everything that was guessed."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import dump_yaml
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.echoes import measured
from sher3_machines.drafting.followed import followed
from sher3_machines.drafting.grouping import once, paired, together
from sher3_machines.drafting.guesses import (
    NAMED,
    clock_of,
    comes_to_rest,
    count_of,
    period_of,
    position_unit,
    reach,
    scatter,
    swings_to_rest,
    time_unit,
    travel,
)
from sher3_machines.drafting.names import COUNTING, DRIVING, LENGTHS, POSITION, parse, words_of
from sher3_machines.drafting.roles import DEMANDED, SIGNALS, Place, moves, placed, values_of
from sher3_machines.drafting.speeds import checked_by_speed
from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import TIME_UNITS, VELOCITIES
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.mending.fields import signed
from sher3_machines.intake.runs import longest
from sher3_machines.intake.spelling import bare, table_of
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import UNITS
from sher3_machines.thresholds import FURTHEST

PLACES = ("reference", "load")
"""Signals that are in the unit of the position where their name says no other."""
ROTARY_UNITS = ("rad", "mrad", "deg", "arcmin", "arcsec", "rev", "count")
ROTARY = (*ROTARY_UNITS, "rad/s", "deg/s", "rev/s", "rpm")
NEWTONS = ("N", "kN", "mN", "gf", "kgf", "lbf", "N*m", "mN*m")
"""Units of forces and torques that add up."""
JOINT_STATES, OF_ROS = "joint_states/", "joint states of ROS are in rad and m"
"""Topic whose messages are in rad and m (REP-103), and what is said of it."""
ELECTRICAL = "its name says so, of electrical turns: `factor` is one over the pairs of poles"
SLIDING_AXES = {"x", "y", "z", "cart", "carriage", "slide", "slider"}
"""Names of axes that slide."""
GEARED = 1.5
"""Travel of one encoder over that of the other from which a gear is between them."""
MOST_GEARED = 1e5
"""Ratio beyond which two columns are not two encoders of one axis."""
FOLLOWS = 0.9
"""Correlation of two encoders below which one does not move with the other: a held axis."""
STEPPED = 0.1
"""Share of the samples up to which what a servo is told changes in steps."""
LISTED = 12
"""Columns that a sentence lists at most."""


def draft(path: Path, rate: float | None = None, tables: Tables | None = None) -> Draft:
    """Draft a description of a chain of axes from a data file, folder or bag.

    Args:
        path: of the data.
        rate: samples per second, Hz, where no time was recorded.
        tables: what the path holds, where it has been read.

    Raises:
        MachineError: the file cannot be read, or no column looks like a time or a position.
    """
    guesses: list[str] = []
    data = drafted(path, longest(path) if tables is None else tables, rate, guesses)
    if sum(axis["command_law"]["kind"] == "force" for axis in data["axes"]) > 1:
        guesses.append(
            "each axis by itself; joints of one arm carry each other: give its URDF or MJCF, --model FILE "
            "(`kind: manipulator`)"
        )
    return written(data, guesses)


def written(data: Mapping[str, Any], guesses: list[str]) -> Draft:
    """Return a description as YAML under its guesses."""
    head = "".join(f"# guessed: {guess}\n" for guess in guesses)
    return Draft(head + dump_yaml(data), guesses)


def name_of(path: Path) -> str:
    """Return the name of a machine after the file of its record."""
    return re.sub(r"\W+", "_", path.stem)


def unused_columns(tables: Tables, used: Collection[str]) -> list[str]:
    """Return the guess that says which columns are not used; [] where all are."""
    left = [n for n in tables if n not in used]
    return [f"not used: {', '.join(left)}"] if left else []


def drafted(path: Path, tables: Tables, rate: float | None, guesses: list[str], held: bool = False) -> dict[str, Any]:
    """Return a description of a chain of axes as plain data, with `held` ones where asked; raises MachineError."""
    clock = None if rate else clock_of(tables, guesses)
    if clock is None:
        time: dict[str, Any] = {"rate": rate}
    else:
        table = table_of(clock)
        alone = table and sum(n.startswith(table + "/") for n in tables) == 1  # a name with a slash, and no table
        time = {"column": clock if alone else bare(clock)}
        time["unit"] = time_unit(clock, tables[clock], guesses)
    roles = followed(placed(tables, clock, guesses, held), tables)
    groups, left = together(paired(roles, tables, guesses))
    own = [f"{table_of(signals['position'][0])}/{bare(clock)}" for signals in groups.values() if clock]
    clock = next((name for name in own if name in tables), clock)  # stamps of the joints, not of another topic
    period = 1.0 / rate if rate else period_of(tables[str(clock)]) * TIME_UNITS[time["unit"]]
    groups = measured(once(groups, tables, guesses), tables, guesses)
    known = {name for name, _ in roles}
    left += [n for n, x in tables.items() if n not in known and n != clock and moves(x)]
    reached: dict[object, float] = {}
    spelt = {axis: _spelt(signals["position"], axis, tables) for axis, signals in groups.items()}
    for axis, signals in groups.items():
        farthest = reach(values_of(signals["position"], tables))
        reached[spelt[axis]] = max(reached.get(spelt[axis], 0.0), farthest)
    axes = [_axis(axis, signals, tables, period, reached[spelt[axis]], guesses) for axis, signals in groups.items()]
    homes = {place for signals in groups.values() for place in signals.values()}
    unhoused = [n for n in tables if n not in {name for name, _ in homes} and moves(tables[n])]
    astray = [n for n in unhoused if parse(n).signal in ("command", "effort")]  # may drive, and found no axis
    for drafted_axis, signals in () if astray else zip(axes, groups.values(), strict=True):
        _let_go(drafted_axis, values_of(signals["position"], tables), guesses, alone=len(axes) == 1)
    checked_by_speed(time, axes, tables, None if clock is None else tables[clock], guesses)
    empty = ", ".join(repr(n) for n, x in tables.items() if not len(x))
    closed = [f"no array in {empty}: an object of MATLAB is opened there alone"] if empty else []
    if not axes:
        most = max(map(len, tables.values()))
        raise MachineError(
            f"{path}: no column looks like a position",
            value="; ".join([", ".join([n for n, x in tables.items() if len(x) == most][:LISTED]), *closed]),
            limit="names with position, pos, q, angle, encoder",
            remedy="give their names in order, an empty one for what is no signal: --names t,position,,effort; or "
            "write the description by hand (`column: c1`; `column: data, index: 1` of a matrix); a force sensor by "
            "itself is `kind: force_sensor`, postures with measured poses are `kind: arm`; levels and temperatures are "
            "no machine",
        )
    guesses += closed
    if len(axes) > 1:
        guesses.extend(f"{n!r} drives one of these axes, and nothing says which: write it there" for n in astray)
    if left:
        more = f" and {len(left) - LISTED} more" if len(left) > LISTED else ""
        guesses.append(f"not used: {', '.join(left[:LISTED])}{more}")
    return {"kind": "axes", "name": name_of(path.resolve()), "time": time, "axes": axes}


def _spelt(place: Place, axis: str, tables: Tables) -> object:
    """Return what places in one unit share: a table, the words of the name but the axis', and whether it slides."""
    name = place[0]
    words = frozenset(words_of(bare(name))) - set(parse(name).axis.split("_")) - set(axis.split("_"))
    return table_of(name), words, _slides(axis, name, tables)


def _slides(axis: str, place: str, tables: Tables) -> bool:
    """Return whether the name of an axis says that it slides, that of its place that it is a length, or a quaternion
    (n, 4) beside the place (n, 3) that it is one of a pose.
    """
    turn = tables.get(place.removesuffix(bare(place)) + "orientation", np.zeros(0))
    pose = tables[place].shape[1:] == (3,) and turn.shape[1:] == (4,)
    return bool(pose or set(axis.split("_")) & SLIDING_AXES or set(words_of(bare(place))) & LENGTHS)


def _unit_of(place: Place, axis: str, tables: Tables, x: Array, reached: float) -> tuple[str, float, str]:
    """Return the unit of a place, its factor, and why; of a velocity that stands for one, the unit of it.

    `reached` is the largest value of all places that are spelt alike.
    """
    what = parse(place[0])
    if what.signal == "velocity":
        said = ELECTRICAL if "erpm" in place[0].lower() else NAMED
        return (what.unit, 1.0, said) if what.unit in VELOCITIES else ("rad/s", 1.0, "it is a velocity")
    if what.unit is None and JOINT_STATES in place[0]:
        return ("m" if _slides(axis, place[0], tables) else "rad"), 1.0, OF_ROS
    counted = what.unit is None and bool((x == np.round(x)).all()) and bool(set(words_of(bare(place[0]))) & COUNTING)
    return position_unit("count" if counted else what.unit, x, _slides(axis, place[0], tables), reached)


def by_motion(label: str, signals: Mapping[str, Place], tables: Tables, guesses: list[str]) -> Mapping[str, Place]:
    """Return the signals of an axis without those that were taken for positions and do not move with it.

    Such a signal is what a drive reports or is told: a `load` without a unit of position is a duty, and a `command`
    that names no position is a force.
    """
    out = dict(signals)
    for signal, force, words in (("load", "effort", "an effort and no encoder"), ("reference", "command", "a command")):
        place = out.get(signal)
        said = set(words_of(bare(place[0]))) if place is not None else set()
        if place is None or parse(place[0]).unit is not None or said & (POSITION | DRIVING):
            continue
        is_force = signal == "load" or (said & DEMANDED and "effort" in out)
        if not is_force or ratio_of(out, tables, signal):
            continue
        del out[signal]
        other = out.setdefault(force, place)
        if other != place and _has_sign(place, tables) > _has_sign(other, tables):
            out[force], words = place, f"{words}, and has a sign, which {other[0]!r} has not"
        words += "" if out[force] == place else ", and not used"
        guesses.append(f"{label}: {place[0]!r} is {words}, because it does not move with the position")
    return out


def _has_sign(place: Place, tables: Tables) -> bool:
    """Return whether a column goes below zero, if only in a field that took its sign."""
    return float(signed(values_of(place, tables))[0].min()) < 0.0


def _axis(
    axis: str, signals: Mapping[str, Place], tables: Tables, period: float, reached: float, guesses: list[str]
) -> dict[str, Any]:
    label = re.sub(r"\W+", "_", axis) or "axis"
    label = f"joint{label}" if label[0].isdigit() else label
    signals = by_motion(label, signals, tables, guesses)
    x = values_of(signals["position"], tables)
    unit, factor, why = _unit_of(signals["position"], axis, tables, x, reached)
    guesses.append(f"{label}: position in {unit}, because {why}")
    columns: dict[str, Any] = {}
    for signal in SIGNALS:
        if signal in signals:
            place = signal in PLACES
            usual = unit if place else per_second(unit) if signal == "velocity" else None
            counts = place or (signal == "velocity" and parse(signals[signal][0]).unit is None)
            columns[signal] = _column(*signals[signal], usual, factor if counts else 1.0)
            if signal not in ("position", "velocity"):
                guesses.append(f"{label}: {signal} is {signals[signal][0]!r}, because of its name")
    _without_other_force(label, columns, guesses)
    own = unit
    columns["position"].update({"unit": unit, **({"factor": factor} if factor != 1.0 else {})})
    if columns.get("reference", {}).get("unit") in TIME_UNITS:
        _as_place(label, columns, x, values_of(signals["reference"], tables), guesses)
    if "load" in signals:
        sliding = columns["load"]["unit"] not in ROTARY_UNITS
        exact = "placeholder" in why or sliding == (unit in ROTARY_UNITS)
        factor *= _gear(label, columns, ratio_of(signals, tables), exact, guesses)
        if _beside(signals, columns, tables):  # a reference of the motor, in its counts
            columns["reference"]["factor"] = columns["position"]["factor"]
        unit, own = columns["load"]["unit"] if sliding else unit, unit
    count = 1.0 if own == "count" and bool((x == np.round(x)).all()) else count_of(x)
    step, said = count or scatter(x) or 1e-6, "its smallest step" if count else "its scatter: no step is seen"
    if own in VELOCITIES:
        step, said = step * period, f"{said}, over a period"
    columns["position"]["step"] = float(f"{step:.6g}")
    guesses.append(f"{label}: one count of its encoder is {step:.3g} of the numbers recorded, {said}")
    law = _law(label, columns, guesses)
    out: dict[str, Any] = {"name": label, "motion": "rotary" if unit in ROTARY else "linear", "signals": columns}
    out["command_law"] = law
    if law["kind"] == "force":
        guesses.append(f"{label}: mass is not known and will be identified from the record; state it where you can")
        out["mass"] = "unknown"
    turns = own == "rev" or own in VELOCITIES  # may well be many
    named_so = why in (NAMED, OF_ROS) and not turns
    return {**out, **(_range(label, x * UNITS[own] * factor, str(out["motion"]), guesses) if named_so else {})}


def _let_go(axis: dict[str, Any], x: Array, guesses: list[str], alone: bool) -> None:
    """Give a body of which only the place (n,) was recorded, and which swings to rest, a mass of one.

    What is moved from one point to another one comes to rest as well; a speed that dies out alone was let go.
    """
    slows = alone and axis["signals"]["position"]["unit"] in VELOCITIES and comes_to_rest(x)
    if axis["command_law"]["kind"] == "none" and (slows or swings_to_rest(x)):
        axis["mass"] = 1.0
        guesses.append(
            f"{axis['name']}: let go, because it comes to rest; its mass of 1 is a placeholder: forces are for each kg "
            "(kg m^2)"
        )


def _as_place(label: str, columns: dict[str, Any], x: Array, pulses: Array, guesses: list[str]) -> None:
    """Read pulses (n,), which a hobby servo is told, as places: a position (n,) says how far it goes for one of them.

    It does so at the end of each rest of steps, else all along. Pulses that stay tell nothing, and are left out.
    """
    place, pulse = columns["position"], columns.pop("reference")
    ends = np.flatnonzero(np.diff(pulses))
    if len(x) != len(pulses) or not len(ends):
        return
    kept = ends if len(ends) < STEPPED * len(x) else slice(None)
    slope, zero = place.get("factor", 1.0) * np.polyfit(pulses[kept], x[kept], 1)
    guesses.append(f"{label}: a pulse of 1 {pulse['unit']} is {slope:.4g} {place['unit']}: the record says so")
    said = {
        "unit": place["unit"],
        "factor": float(f"{slope:.6g}"),
        "offset": float(f"{zero * UNITS[place['unit']]:.6g}"),
    }
    columns["reference"] = pulse | said | {"override": True}


def _without_other_force(label: str, columns: dict[str, Any], guesses: list[str]) -> None:
    """Leave out a force from outside that is no force of the drive's kind: a weight beside a torque, or a current."""
    drive = columns.get("effort", columns.get("command"))
    if drive is None or "applied" not in columns:
        return
    units = [columns["applied"]["unit"], drive["unit"]]
    torques = [unit.endswith("N*m") for unit in units]
    if torques[0] != torques[1] or not set(units) <= set(NEWTONS):
        out = columns.pop("applied")["column"]
        guesses.append(f"{label}: {out!r} is not used, because it is in {units[0]} and the drive's force in {units[1]}")


def _range(label: str, x: Array, motion: str, guesses: list[str]) -> dict[str, Any]:
    """Return the range of a place (n,), m or rad, that goes further than most; of others none."""
    if reach(x) < FURTHEST[motion]:
        return {}
    end = float(np.ceil(reach(x)))
    guesses.append(f"{label}: range of {end:.6g} {'rad' if motion == 'rotary' else 'm'} both ways, which it needs")
    return {"range": [-end, end]}


def per_second(unit: str) -> str:
    """Return the unit of velocity that goes with a unit of position, mm/s with mm; rad/s where there is none."""
    return f"{unit}/s" if f"{unit}/s" in VELOCITIES else "rad/s"


def _column(name: str, index: int | None, unit: str | None, factor: float) -> dict[str, Any]:
    own = parse(name).unit
    found: dict[str, Any] = {"column": name, "unit": own or unit or "1"}
    if index is not None:
        found["index"] = index
    if factor != 1.0 and own in (None, unit):
        found["factor"] = factor
    return found


def ratio_of(signals: Mapping[str, Place], tables: Tables, other: str = "load") -> float:
    """Return how far the position moves per unit of another place; 0 where that does not move with it."""
    x, y = (values_of(signals[k], tables) for k in ("position", other))
    if not travel(y):
        return 0.0
    if len(x) != len(y):
        return travel(x) / travel(y)
    if abs(np.corrcoef(x, y)[0, 1]) < FOLLOWS:
        return 0.0
    about = y - np.median(y)
    return float(abs(about @ (x - np.median(x))) / (about @ about))


def _gear(label: str, columns: dict[str, Any], ratio: float, exact: bool, guesses: list[str]) -> float:
    """Return the factor by which the position is that of the load, where a gear is between the two encoders.

    Counts of a turn that nobody knows, and the lead of a screw, are told by the load in the same factor: it is then
    `exact` and no whole number.
    """
    scales = [UNITS[columns[k]["unit"]] * columns[k].get("factor", 1.0) for k in ("position", "load")]
    ratio *= scales[0] / scales[1]
    if 1.0 / GEARED < ratio < GEARED or not 1.0 / MOST_GEARED < ratio < MOST_GEARED:
        return 1.0
    whole = ratio if exact else round(ratio) if ratio > GEARED else 1.0 / round(1.0 / ratio)
    factor = float(f"{1.0 / whole:.6g}")
    columns["position"]["factor"] = columns["position"].get("factor", 1.0) * factor
    guesses.append(f"{label}: a gear of {whole:.6g} between the encoders, because the position moves {ratio:.4g} times")
    return factor


def _beside(signals: Mapping[str, Place], columns: Mapping[str, Any], tables: Tables) -> bool:
    """Return whether a reference moves by as many of its units as the position does, behind a gear of the load."""
    if "reference" not in signals or "factor" not in columns["position"]:
        return False
    x, asked = (travel(values_of(signals[k], tables)) for k in ("position", "reference"))
    return columns["reference"]["unit"] == columns["position"]["unit"] and x < GEARED * asked < GEARED**2 * x


def _law(axis: str, columns: Mapping[str, Any], guesses: list[str]) -> dict[str, Any]:
    if "effort" in columns or "command" in columns:
        unit = columns["effort" if "effort" in columns else "command"]["unit"]
        own = "the unit recorded, which nobody states," if unit == "1" else unit
        counts = "" if unit in ("N", "N*m") else f"; forces are in {own} until `factor` or `gain` makes them N or N m"
        guesses.append(f"{axis}: driven by a force{counts}")
        return {"kind": "force"}
    if "reference" in columns:
        guesses.append(f"{axis}: a position servo, because a reference and no force was recorded")
        return {"kind": "position"}
    guesses.append(f"{axis}: undriven, because neither reference nor force was found")
    return {"kind": "none"}
