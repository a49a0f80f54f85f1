"""Columns that nobody named: names that a user gives in their order, and what the numbers alone tell.

Tables without a header have columns c0, c1, ...; a matrix has entries. What is named here goes the way of every other
name; the draft then speaks of the columns as the file has them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import permutations
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.guesses import evenly, grows
from sher3_machines.errors import MachineError
from sher3_machines.intake.mending.motion import AGREES, FOLLOWS, speed_of, speed_ratio
from sher3_machines.intake.tables import SAMPLES, Tables

WITHOUT = re.compile(r"c\d+|")
"""Names of columns that have none."""
MOST = 12
"""Columns of a matrix that is taken for a table at most."""

Place = tuple[str, int | None]
"""A column, and the entry of it where each sample is a list."""


def places_of(tables: Tables) -> list[Place]:
    """Return the columns and the entries of matrices with most samples, in the order of the file."""
    most = max((len(x) for x in tables.values()), default=0)
    found: list[Place] = []
    for name, x in tables.items():
        if len(x) == most >= SAMPLES and (x.ndim == 1 or (x.ndim == 2 and x.shape[1] <= MOST)):
            found += [(name, None)] if x.ndim == 1 else [(name, i) for i in range(x.shape[1])]
    return found


def given(names: Sequence[str], tables: Tables) -> dict[Place, str]:
    """Return the names that a user gave to the columns in their order; one that is empty leaves its column out.

    Raises:
        MachineError: there are more or fewer names than columns, or two are alike.
    """
    places = places_of(tables)
    told = [name for name in names if name]
    if len(names) != len(places) or len(set(told)) < len(told):
        raise MachineError(
            "names do not fit the columns",
            value=", ".join(names),
            limit=f"{len(places)} different ones: {', '.join(_said(place) for place in places)}",
            remedy="give one name for each column, as in `--names t,q,i`; an empty one leaves its column out",
        )
    return {place: name for place, name in zip(places, names, strict=True) if name}


def told_by_motion(tables: Tables, rate: float | None, guesses: list[str]) -> dict[Place, str]:
    """Return names for columns without any: the time grows evenly, and a speed is what a place is the integral of.

    Empty where there is no time, or where no two columns without a name are place and speed.
    """
    unnamed = [place for place in places_of(tables) if place[1] is not None or WITHOUT.fullmatch(place[0])]
    columns = {place: values_at(place, tables) for place in unnamed}
    clock = next((p for p, x in columns.items() if grows(x) and evenly(x)), None) if rate is None else None
    if not columns or (clock is None and rate is None):
        return {}
    t = columns[clock] if clock else np.arange(len(next(iter(columns.values())))) / float(rate or 1.0)
    moving = {p: x for p, x in columns.items() if p != clock and np.isfinite(x).all() and float(np.ptp(x)) > 0.0}
    ahead = np.concatenate([[True], np.diff(t) > 0.0])
    pairs = [(x, v) for x, v in permutations(moving, 2) if _is_speed(t[ahead], moving[x][ahead], moving[v][ahead])]
    speeds = {v for _, v in pairs}
    found = [(x, v) for x, v in pairs if x not in speeds]
    if not found:
        return {}
    x, v = found[0]
    guesses.append(f"{_said(x)} is a position, because {_said(v)} is its speed; nobody named them")
    rest = [_said(p) for p in moving if p not in (x, v)]
    guesses.extend([f"not told by the motion: {', '.join(rest)}; name them: --names t,q,..."] if rest else [])
    return {**({clock: "time"} if clock else {}), x: "position", v: "velocity"}


def _is_speed(t: Array, x: Array, v: Array) -> bool:
    """Return whether one column (n,) is the speed of another: it adds up to the travel and follows its slope to zero.

    What a motion drives, such as a pressure that a piston's speed lifts, follows its slope from another zero.
    """
    ratio = speed_ratio(t, x, v)
    if ratio is None or ratio <= 0.0:
        return False
    slope, sums = speed_of(t, x), np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    follows = float(np.corrcoef(slope, speed_of(t, sums))[0, 1]) > FOLLOWS
    strays = abs(x[-1] - x[0] - ratio * sums[-1]) / (t[-1] - t[0])
    return follows and bool(strays < AGREES * np.sqrt(np.mean(slope**2)))


def values_at(place: Place, tables: Tables) -> Array:
    """Return the numbers of a column or of an entry of it."""
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


def _said(place: Place) -> str:
    return place[0] if place[1] is None else f"{place[0]}[{place[1]}]"
