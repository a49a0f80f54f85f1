"""Records of positioning tests, with the checks that refuse tables no answer could rest on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick, pick_beside
from sher3_machines.intake.fields import Column
from sher3_machines.intake.tables import Tables

from sher3_static.positioning.description import AxisTest, CircleTest, PositioningDescription
from sher3_static.readings import Readings, enough

LEAST_ROWS = 20
"""Rows that a test must have: five targets, from both sides, twice."""
MORE_ROWS = "measure more cycles: five targets from both sides, twice, are enough"
LEAST_TARGETS = 3
"""Targets that a test must have: two tell no more than a line."""
LIKELY_SLIP = 0.1
"""Deviation, as a share of the travel, beyond which reading and target are taken for different units."""


def read_tests(name: str, tables: Tables, machine: PositioningDescription) -> Readings:
    """Check the columns of a file and bring them to SI units.

    Returns:
        `axes/AXIS/COLUMN` with `target`, `deviation`, `direction`, `cycle`, and `temperature` where it was recorded;
        `planes/PLANE/COLUMN` with `x` and `y`, m.

    Raises:
        MachineError: a column is missing, rows or targets are too few, or units differ.
    """
    notes: list[str] = []
    found = {f"axes/{test.name}": axis_rows(name, tables, test, notes) for test in machine.axes}
    found |= {f"planes/{test.name}": circle_rows(name, tables, test) for test in machine.planes}
    columns = {f"{test}/{column}": x for test, rows in found.items() for column, x in rows.items()}
    return Readings(name, columns, notes)


def axis_rows(run: str, tables: Tables, test: AxisTest, notes: list[str]) -> dict[str, Array]:
    """Return the rows (n,) of one axis by column; raises MachineError where there are too few or unlikely ones."""
    if test.passes is not None:
        return pass_rows(run, tables, test, test.passes)
    target = pick(test.target, tables, run)
    _one_column(run, test.target, target)
    _enough(run, test.name, len(target), target)
    column = test.reading or test.deviation
    assert column is not None
    value = pick_beside(target.shape, column, tables, run)
    deviation = from_zero(run, test, value - target, target, notes) if test.reading is not None else value
    _likely(run, test, column, target, deviation)
    rows = {"target": target, "deviation": deviation}
    if test.direction is not None:
        rows["direction"] = np.sign(pick_beside(target.shape, test.direction, tables, run))
        if not rows["direction"].all():
            remedy = "give numbers above and below zero, or leave `direction` out"
            at = int(np.argmin(np.abs(rows["direction"]))) + 1
            raise MachineError(f"{run}: {test.direction.column} has no sign at row {at}", value=0, remedy=remedy)
    else:
        rows["direction"] = directions(target)
        notes.append(f"{run}: {test.name}: directions of approach are taken from the order of the rows")
    if test.cycle is not None:
        rows["cycle"] = np.unique(pick_beside(target.shape, test.cycle, tables, run), return_inverse=True)[1].astype(
            float
        )
    else:
        rows["cycle"] = cycles(target, rows["direction"])
        notes.append(f"{run}: {test.name}: {int(rows['cycle'].max()) + 1} cycles counted from repeated targets")
    if test.temperature is not None:
        rows["temperature"] = pick_beside(target.shape, test.temperature, tables, run)
    return rows


def pass_rows(run: str, tables: Tables, test: AxisTest, passes: Sequence[Column]) -> dict[str, Array]:
    """Return the rows (n,) of a table with a column for each pass: from below, from above and so on, in turn."""
    target = pick(test.target, tables, run)
    _one_column(run, test.target, target)
    _enough(run, test.name, len(target) * len(passes), target)
    found = [pick_beside(target.shape, column, tables, run) for column in passes]
    for column, deviation in zip(passes, found, strict=True):
        _likely(run, test, column, target, deviation)
    warm = None if test.temperature is None else pick_beside(target.shape, test.temperature, tables, run)
    parts = []
    for k, deviation in enumerate(found):  # each in the order in which it was measured
        there = np.argsort(target) if k % 2 == 0 else np.argsort(-target)
        side = np.full(len(target), 1.0 if k % 2 == 0 else -1.0)
        part = {"target": target[there], "deviation": deviation[there], "direction": side}
        part["cycle"] = np.full(len(target), float(k // 2))
        parts.append(part if warm is None else {**part, "temperature": warm[there]})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def from_zero(run: str, test: AxisTest, deviation: Array, target: Array, notes: list[str]) -> Array:
    """Return deviations (n,) of a reading that counts from another place, such as an absolute encoder's, from there.

    They then lie together, further off than a travel allows; those of a wrong unit do not.
    """
    zero, allowed = float(np.median(deviation)), LIKELY_SLIP * np.ptp(target)
    if abs(zero) < allowed or (np.abs(deviation - zero) > allowed).any():
        return deviation
    notes.append(f"{run}: {test.name}: its reading counts from {zero:.6g}; taken off")
    return deviation - zero


def _likely(run: str, test: AxisTest, column: Column, target: Array, deviation: Array) -> None:
    worst = int(np.argmax(np.abs(deviation)))
    if abs(deviation[worst]) > LIKELY_SLIP * np.ptp(target):
        raise MachineError(
            f"{run}: {test.name}: {column.column} deviates by more than its travel allows at row {worst + 1}",
            value=f"{deviation[worst]:.4g}",
            limit=f"{LIKELY_SLIP * np.ptp(target):.4g}",
            remedy="correct the units of target and reading in the description",
        )


def directions(target: Array) -> Array:
    """Return +1 or -1 (n,) from the order of the targets; one met twice in a row is then met from behind."""
    step = np.sign(np.diff(target))
    out = np.empty(len(target))
    out[0] = step[np.flatnonzero(step)[0]]
    for i, s in enumerate(step, start=1):
        out[i] = s if s else -out[i - 1]
    return out


def cycles(target: Array, direction: Array) -> Array:
    """Return how often each row's target was met from the same side before, (n,)."""
    seen: dict[tuple[float, float], int] = {}
    out = np.empty(len(target))
    for i, key in enumerate(zip(target, direction, strict=True)):
        out[i] = seen[key] = seen.get(key, -1) + 1
    return out


def circle_rows(run: str, tables: Tables, test: CircleTest) -> dict[str, Array]:
    """Return the points (n,) of one circle, m; raises MachineError where they are too few or are no circle."""
    first, second = (test.x, test.y) if test.x is not None else (test.angle, test.deviation)
    assert first is not None and second is not None
    x = pick(first, tables, run)
    _one_column(run, first, x)
    y = pick_beside(x.shape, second, tables, run)
    if test.angle is not None:
        x, y = (test.radius + y) * np.cos(x), (test.radius + y) * np.sin(x)
    enough(f"{run}: {test.name}: too few rows", len(x), LEAST_ROWS, MORE_ROWS)
    size = float(np.hypot(x - x.mean(), y - y.mean()).mean())
    if not 0.5 < size / test.radius < 2.0:
        raise MachineError(
            f"{run}: {test.name}: the points are no circle of the stated radius",
            value=f"{size:.4g}",
            limit=f"{test.radius:g} m",
            remedy="correct `radius` or the units of x and y",
        )
    return {"x": x, "y": y}


def _one_column(run: str, column: Column, x: Array) -> None:
    if x.ndim != 1:
        remedy = "pick one of its columns with `index`"
        raise MachineError(f"{run}: {column.column} is a matrix", value=x.shape, limit="(n,)", remedy=remedy)


def _enough(run: str, name: str, rows: int, target: Array) -> None:
    enough(f"{run}: {name}: too few rows", rows, LEAST_ROWS, MORE_ROWS)
    enough(f"{run}: {name}: too few targets", len(np.unique(target)), LEAST_TARGETS, "measure more targets")
