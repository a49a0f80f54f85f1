"""Columns that nobody named: names that a user gives in their order, and what the numbers alone tell.

Tables without a header have columns c0, c1, ...; a matrix has entries. What is named here goes the way of every other
name; the draft then speaks of the columns as the file has them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.guesses import CROSSINGS, counts_rows, evenly, grows, swings_to_rest
from sher3_machines.drafting.names import TELLING, bare_and_unit, parse, tells_time, words_of
from sher3_machines.errors import MachineError
from sher3_machines.intake.mending.motion import AGREES, FOLLOWS, speed_of, speed_ratio
from sher3_machines.intake.spelling import bare, table_of
from sher3_machines.intake.tables import SAMPLES, Tables

WITHOUT = re.compile(r"c\d+|")
"""Names of columns that have none."""
MOST = 12
"""Columns of a matrix that is taken for a table at most."""

LEVELS = 3
"""Rows of a table of readings at least."""
POSITION, VELOCITY, ACCELERATION, EFFORT = "position", "velocity", "acceleration", "effort"
"""Names of the blocks of a table of a robot."""
REFERENCE = "reference"
LATEST = 20
"""Part of a record by which a place is late after its reference at most."""
ROWS = 5000
"""Rows of a record that tell so, of a longer one every second or third row: each lateness takes a look at all."""
HELD = 0.5
"""Share of the rows in which a reference that does not swing changes at most: it is told in steps."""
AS_FAR = 1.25
"""Travel of one over that of the other from which a place is not told another one: a voltage, of a speed."""
CIRCLE = 1e-2
"""Share of the square of a radius by which a point on a circle leaves it: a joint that is turned before a tracker."""
ROUND = 1.0
"""Radians that such a point goes round at least: any smooth curve is a short arc of a large circle."""
BALANCED = 0.5
"""Share of what a line over the place leaves of a force that slope, size and sense of the speed explain, at least."""
HALF = 0.5
"""Share of a place that a line over a column leaves at most where the column is another place, or one asked for."""
SAME = 0.1
"""Part by which a column differs from the slope of a speed up to which it is that slope."""
TINY = 1e-300

Place = tuple[str, int | None]
"""A column, and the entry of it where each sample is a list."""


def places_of(tables: Tables, least: int = SAMPLES) -> list[Place]:
    """Return the columns and the entries of matrices with most samples, `least` or more, in the order of the file."""
    most = max((len(x) for x in tables.values()), default=0)
    found: list[Place] = []
    for name, x in tables.items():
        if len(x) == most >= least and (x.ndim == 1 or (x.ndim == 2 and x.shape[1] <= MOST)):
            found += [(name, None)] if x.ndim == 1 else [(name, i) for i in range(x.shape[1])]
    return found


def given(names: Sequence[str], tables: Tables) -> dict[Place, str]:
    """Return the names that a user gave to the columns in their order; one that is empty leaves its column out.

    Raises:
        MachineError: there are more or fewer names than columns, or two are alike.
    """
    places = places_of(tables, LEVELS)
    kept = [name for name in names if name]
    if len(names) != len(places) or len(set(kept)) < len(kept):
        raise MachineError(
            "names do not fit the columns",
            value=", ".join(names),
            limit=f"{len(places)} different ones: {', '.join(place_text(place) for place in places)}",
            remedy="give one name for each column, as in `--names t,q,i`; an empty one leaves its column out",
        )
    return {place: _in_unit(name, place[0]) for place, name in zip(places, names, strict=True) if name}


def _in_unit(name: str, column: str) -> str:
    """Return a name with the unit of the column that it is given to, where it states none itself."""
    unit = bare_and_unit(bare(column))[1]
    return name if unit is None or bare_and_unit(name)[1] else f"{name} [{unit}]"


def named_by_motion(tables: Tables, rate: float | None, guesses: list[str]) -> dict[Place, str]:
    """Return names for columns that have none: the time grows evenly, and a position is the integral of its speed.

    A title that says nothing of a signal is none, and a speed alone tells its place there. Elsewhere, where no column
    is the speed of another, a position is what follows a reference later, or what swings to rest alone; of the columns
    beside a place and its speed the one that the motion balances best is what drives. Several places with their speeds
    are blocks of a robot's joints. Each table of a folder is told by itself. Empty where there is no time, or
    where the motion tells nothing.
    """
    of_table: dict[str, Tables] = {}
    for name, x in tables.items():
        of_table.setdefault(table_of(name), {})[name] = x
    told = {table: _name_columns(own, rate, guesses) for table, own in of_table.items()}
    return {p: f"{table}/{name}" if table else name for table, own in told.items() for p, name in own.items()}


def clock_among(tables: Tables) -> str:
    """Return the column without a name that is the time, as `data[0]`; empty where none is."""
    clock, _, columns = _timed(tables, None)
    return place_text(clock) if clock and not _titled([clock, *columns]) else ""


def _titled(places: Iterable[Place]) -> bool:
    """Return whether one of some columns has a title of its own."""
    return any(index is None and not WITHOUT.fullmatch(bare(name)) for name, index in places)


def _name_columns(tables: Tables, rate: float | None, guesses: list[str]) -> dict[Place, str]:
    """Return names for the columns of one table that have none."""
    clock, t, columns = _timed(tables, rate)
    moving = {p: x for p, x in columns.items() if np.isfinite(x).all() and float(np.ptp(x)) > 0.0}
    pairs = [(x, v) for x, v in permutations(moving, 2) if _is_speed(t, moving[x], moving[v])]
    # Its own speed comes before what the motion drives.
    pairs.sort(key=lambda pair: line_residual(np.gradient(moving[pair[0]], t), moving[pair[1]])[0])
    speeds = {v for _, v in pairs}
    found = [(x, v) for x, v in pairs if x not in speeds]
    places = dict.fromkeys(x for x, _ in found)
    asked = [r for r in places if any(_follows(moving[x], moving[r]) for x in places if x is not r)]
    asked = asked if 2 * len(asked) == len(places) else []  # each place has its own
    found = [(x, v) for x, v in found if x not in asked]
    titled = _titled(columns)
    least = len({x for x, _ in found})  # joints that move
    for joints in range(least, len(columns) // 2 + 1) if least > 1 and not titled else ():
        if blocks := named_by_blocks(tables, rate, joints, guesses):
            return blocks
    followers = (
        [] if found or titled else [(x, r) for x, r in permutations(moving, 2) if _follows(moving[x], moving[r])]
    )
    if found or followers:
        (x, other), role = (found or followers)[0], VELOCITY if found else REFERENCE
        why = "its speed" if found else "what it follows"
        guesses.append(f"{place_text(x)} is a position, because {place_text(other)} is {why}; nobody named them")
        named = {x: POSITION, other: role} | ({asked[0]: REFERENCE} if len(asked) == 1 else {})
    elif len(moving) == 1 and not titled and swings_to_rest(*moving.values()):
        (x,) = moving
        guesses.append(
            f"{place_text(x)} is a position, because it swings to rest and nothing else moves; nobody named it"
        )
        named = {x: POSITION}
    else:
        return {}
    if found:
        named |= _names_beside(t, x, moving, named, guesses)
    rest = ", ".join(place_text(p) for p in moving if p not in named)
    guesses.extend([f"not told by the motion: {rest}; name them: --names t,q,..."] if rest else [])
    told = {(name, None): name for name in tables if titled and (name, None) not in columns}
    return {**({clock: "time"} if clock else {}), **named, **told}


def _names_beside(
    t: Array, x: Place, columns: Mapping[Place, Array], named: Mapping[Place, str], guesses: list[str]
) -> dict[Place, str]:
    """Return names of columns (n,) beside a place `x` with its speed: what it follows, and what balances its motion."""
    out: dict[Place, str] = {}
    place, speed = columns[x], next(columns[p] for p, name in named.items() if name == VELOCITY)
    left = [p for p in columns if p not in named]
    near = [p for p in left if _is_near(place, columns[p])]
    ahead = [p for p in near if REFERENCE not in named.values() and _follows(place, columns[p])]
    if ahead:
        followed = min(ahead, key=lambda p: line_residual(place, columns[p])[0])
        guesses.append(f"{place_text(followed)} is the reference, because the place follows it; nobody named it")
        out[followed] = REFERENCE
    unbalanced = {p: _unbalanced(t, place, speed, columns[p]) for p in left if p not in near}
    drive = min(unbalanced, key=lambda p: unbalanced[p], default=None)
    if drive is not None and unbalanced[drive] < 1.0 - BALANCED:
        guesses.append(f"{place_text(drive)} is the effort, because it balances the motion; nobody named it")
        out[drive] = EFFORT
    return out


def _is_near(x: Array, other: Array) -> bool:
    """Return whether a column (n,) goes where a place goes, in either sense: it is asked for or read, and no force.

    It spans the same numbers, however late and rounded the place is, or lies along a line from another zero.
    """
    share, slope = line_residual(x, other)
    ends, spans = np.array([x.min(), x.max()]), [np.array([y.min(), y.max()]) for y in (other, -other)]
    alike = any(np.abs(ends - span).max() < (AS_FAR - 1.0) * np.ptp(ends) for span in spans)
    return alike or (share < HALF and 1.0 / AS_FAR < abs(slope) < AS_FAR)


def _unbalanced(t: Array, x: Array, v: Array, force: Array) -> float:
    """Return what inertia and friction of a place with its speed leave of a column (n,), of the variance that a line
    over the place leaves; 1 where it is the slope of the speed.
    """
    slope = np.gradient(v, t)
    share, ratio = line_residual(slope, force)
    if share < SAME and abs(ratio - 1.0) < SAME:
        return 1.0
    weight, moved = np.column_stack([np.ones_like(x), x]), np.column_stack([slope, v, np.sign(v)])
    about = force - weight @ np.linalg.lstsq(weight, force, rcond=None)[0]
    both = np.column_stack([weight, moved])
    left = force - both @ np.linalg.lstsq(both, force, rcond=None)[0]
    return float(np.var(left)) / max(float(np.var(about)), TINY)


def _follows(x: Array, asked: Array) -> bool:
    """Return whether a column (n,) is another one some samples later, in its size if not in its sense.

    What goes smoothly one way and back is late after all that does.
    """
    x, asked = (y[:: len(x) // ROWS + 1] for y in (x, asked))
    latest = len(x) // LATEST
    sides = np.sign(asked - asked.mean())
    if np.sum(np.diff(sides) != 0.0) < CROSSINGS and np.mean(np.diff(asked) != 0.0) > HELD:
        return False
    left = {d: line_residual(x[latest:], asked[latest - d : len(asked) - d]) for d in range(latest + 1)}
    best = min(left, key=lambda d: left[d][0])
    return best > 0 and left[best][0] < 1.0 - FOLLOWS and 1.0 / AS_FAR < abs(left[best][1]) < AS_FAR


def line_residual(x: Array, y: Array) -> tuple[float, float]:
    """Return the share of the variance of one column (n,) that a line over another one leaves, and its slope."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y) / max(float(y @ y), TINY)
    return float(np.sum((x - slope * y) ** 2)) / max(float(x @ x), TINY), slope


def named_by_blocks(tables: Tables, rate: float | None, joints: int, guesses: list[str]) -> dict[Place, str]:
    """Return names for a table that has none and holds blocks of columns, with a column for each joint of a robot.

    One block is the speed of another block. The block that is left is the effort; of two that are left, the block that
    follows the slope of the speed more closely is the acceleration. Empty where no block is the speed of another.

    Args:
        tables: of the file.
        rate: samples per second, Hz, where no time was recorded.
        joints: of the model, in the order of the columns.
        guesses: so far.
    """
    clock, t, columns = _timed(tables, rate)
    places = list(columns)
    if len(places) % joints or len(places) < 2 * joints:
        return {}
    blocks = [places[i : i + joints] for i in range(0, len(places), joints)]
    signals = [np.column_stack([columns[p] for p in block]) for block in blocks]
    pairs = [(i, j) for i, j in permutations(range(len(blocks)), 2) if _are_speeds(t, signals[i], signals[j])]
    speed = dict(sorted(pairs, key=lambda pair: _like(np.gradient(signals[pair[0]], t, axis=0), signals[pair[1]])))
    first = next((i for i in speed if i not in speed.values()), None)
    if first is None:
        return {}
    kinds = {first: POSITION, speed[first]: VELOCITY}
    slope = np.gradient(signals[speed[first]], t, axis=0)
    left = sorted((i for i in range(len(blocks)) if i not in kinds), key=lambda i: _like(slope, signals[i]))
    kinds |= dict(zip(left, (EFFORT, ACCELERATION), strict=False)) if len(left) < 3 else {}
    for i, kind in kinds.items():
        why = "it is what is left" if kind == EFFORT else "the motion says so"
        guesses.append(
            f"{place_text(blocks[i][0])} to {place_text(blocks[i][-1])} are the {kind} of {joints} joints: {why}"
        )
    named = {place: f"{kind}_{n}" for i, kind in kinds.items() for n, place in enumerate(blocks[i], 1)}
    return {**({clock: "time"} if clock and named else {}), **named}


def _like(x: Array, y: Array) -> float:
    """Return how columns (n, k) correlate with those of another block, in the mean over those that move."""
    x, y = (block - block.mean(axis=0) for block in (x, y))
    norm = np.linalg.norm(x, axis=0) * np.linalg.norm(y, axis=0)
    return float(np.sum(np.sum(x * y, axis=0)[norm > 0.0] / norm[norm > 0.0]) / max(int((norm > 0.0).sum()), 1))


def _are_speeds(t: Array, x: Array, v: Array) -> bool:
    """Return whether most of the columns that move of one block (n, k) are the speeds of those of another."""
    moving = np.flatnonzero((np.ptp(x, axis=0) > 0.0) & (np.ptp(v, axis=0) > 0.0))
    return 2 * sum(_is_speed(t, x[:, i], v[:, i]) for i in moving) > len(moving)


def _timed(tables: Tables, rate: float | None) -> tuple[Place | None, Array, dict[Place, Array]]:
    """Return the clock, its stamps (n,) and the other columns without a name, (n,) each, where the clock runs forward.

    Without a clock and a rate there are no columns.
    """
    columns = {place: values_at(place, tables) for place in places_of(tables) if _mute(place[0])}
    clocks = [p for p, x in columns.items() if grows(x) and (evenly(x) or tells_time(p[0]))] if rate is None else []
    clock = next((p for p in clocks if not counts_rows(columns[p])), clocks[0] if clocks else None)
    if not columns or (clock is None and rate is None):
        return None, np.zeros(0), {}
    t = columns.pop(clock) if clock else np.arange(len(next(iter(columns.values())))) / float(rate or 1.0)
    ahead = np.concatenate([[True], np.diff(t) > 0.0])
    return clock, t[ahead], {p: x[ahead] for p, x in columns.items()}


def _mute(name: str) -> bool:
    """Return whether a name says nothing of a signal, if only that it is the time."""
    said = set(words_of(bare_and_unit(bare(name))[0]))
    return bool(WITHOUT.fullmatch(bare(name))) or tells_time(bare(name)) or not (said & TELLING or parse(name).signal)


def _is_speed(t: Array, x: Array, v: Array) -> bool:
    """Return whether one column (n,) is the speed of another: it adds up to the travel and follows its slope to zero.

    What a motion drives, such as a pressure that a piston's speed lifts, follows its slope from another zero.
    """
    ratio = speed_ratio(t, x, v)
    if ratio is None or ratio <= 0.0 or _on_a_circle(x, v):
        return False
    slope, sums = speed_of(t, x), np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    follows = float(np.corrcoef(slope, speed_of(t, sums))[0, 1]) > FOLLOWS
    strays = abs(x[-1] - x[0] - ratio * sums[-1]) / (t[-1] - t[0])
    return follows and bool(strays < AGREES * np.sqrt(np.mean(slope**2)))


def _on_a_circle(x: Array, y: Array) -> bool:
    """Return whether two columns (n,) are a point that runs on a circle: each follows the slope of the other."""
    columns, squares = np.column_stack([x, y, np.ones_like(x)]), x**2 + y**2
    a, b, c = np.linalg.lstsq(columns, squares, rcond=None)[0]
    left = squares - columns @ np.array([a, b, c])
    turned = np.unwrap(np.arctan2(y - 0.5 * b, x - 0.5 * a))
    return bool(np.std(left) < CIRCLE * (c + 0.25 * (a**2 + b**2)) and np.ptp(turned) > ROUND)


def values_at(place: Place, tables: Tables) -> Array:
    """Return the numbers (n,) of a column or of an entry of it."""
    name, index = place
    return tables[name] if index is None else np.asarray(tables[name][:, index])


def renamed(names: Mapping[Place, str], tables: Tables) -> Tables:
    """Return the columns that have a name now, under it."""
    return {name: values_at(place, tables) for place, name in names.items()}


def as_recorded(description: Any, names: Mapping[Place, str]) -> Any:
    """Return a description whose columns are those of the file again."""
    back = {name: place for place, name in names.items()}
    if isinstance(description, list):
        return [as_recorded(part, names) for part in description]
    if not isinstance(description, dict):
        return description
    out = {key: as_recorded(part, names) for key, part in description.items()}
    if description.get("column") in back:
        column, index = back[description["column"]]
        out |= {"column": column, **({} if index is None else {"index": index})}
    return out


def place_text(place: Place) -> str:
    """Return a column, or an entry of one, as people write it."""
    return place[0] if place[1] is None else f"{place[0]}[{place[1]}]"
