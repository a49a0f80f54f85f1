"""Which columns are signals of one axis, and which axes are one: told twice, or by an encoder at each end."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from sher3_machines.drafting.names import (
    ASKED,
    DERIVED,
    MEASURED,
    MODELLED,
    POSITION,
    VELOCITY,
    parse,
    vocabulary,
    words_of,
)
from sher3_machines.drafting.roles import EVERY, SIGNALS, Place, moves, values_of
from sher3_machines.intake.spelling import bare, table_of
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import UNITS

ROUNDED = 1e-5
"""Share of the travel by which two columns of one reading differ at most: they were printed with five digits."""
MEMBERS = vocabulary("joint joints axis axes motor motors wheel wheels left right l r leg arm")
"""Words for a part of a machine that moves by itself."""
TOGETHER = 0.999
"""Correlation of two places from which they are readings of one axis: play and springs leave some thousandths."""


def together(placed: Mapping[Place, tuple[str, str]]) -> tuple[dict[str, dict[str, Place]], list[str]]:
    """Return axis -> signal -> column, of axes with a position, and the columns that found no axis.

    A column whose name has no axis of its own, or another one than every position, belongs to the only axis there is,
    or to the one axis whose name ends in the same number, where it has none of its own. Of two columns for one signal
    the one that was measured, in the table of the position, comes first. Where a topic has a table for each joint, what
    other topics count as a place is no joint.
    """
    groups: dict[str, dict[str, Place]] = {}
    for place, (signal, axis) in sorted(placed.items(), key=lambda item: _rank(item[0], "")):
        if signal == "position":
            groups.setdefault(axis, {}).setdefault(signal, place)
    joints = join_topics(groups)
    tables = {table_of(signals["position"][0]) for signals in joints.values()}
    table = tables.pop() if len(tables) == 1 else ""
    left = [s["position"][0] for axis, s in groups.items() if axis not in joints]
    groups = joints
    ranked = sorted(placed.items(), key=lambda item: (item[1][1] not in groups, *_rank(item[0], table)))
    for place, (signal, axis) in ranked:
        if axis == EVERY:
            for signals in groups.values():
                signals.setdefault(signal, place)
            continue
        home = axis if axis in groups else _home(axis, groups)
        if signal not in SIGNALS or home is None or groups[home].setdefault(signal, place) != place:
            left.append(place[0])
    return groups, list(dict.fromkeys(left))


def join_topics(groups: dict[str, dict[str, Place]]) -> dict[str, dict[str, Place]]:
    """Return the axes of topics with a table for each of several joints, `joint_states/elbow/position`; else all."""
    places = {axis: signals["position"][0] for axis, signals in groups.items()}
    topics = {axis: (table_of(table_of(place)), bare(place)) for axis, place in places.items()}
    tables = Counter((table_of(table_of(place)), bare(place)) for place in set(places.values()))
    several = {topic for topic, count in tables.items() if topic[0] and count > 1}
    return {axis: signals for axis, signals in groups.items() if not several or topics[axis] in several}


def once(groups: dict[str, dict[str, Place]], tables: Tables, guesses: list[str]) -> dict[str, dict[str, Place]]:
    """Return the axes without those whose position is that of another one in another unit: rad, and turns."""
    out: dict[str, dict[str, Place]] = {}
    for axis, signals in groups.items():
        place = signals["position"]
        same = next((s["position"] for s in out.values() if _same(place, s["position"], tables)), None)
        if same is None:
            out[axis] = signals
        else:
            guesses.append(f"{place[0]!r} is {same[0]!r} in another unit, and not used")
    return out


def paired(
    placed: Mapping[Place, tuple[str, str]], tables: Tables, guesses: list[str]
) -> Mapping[Place, tuple[str, str]]:
    """Return the signals with two places that move together as those of one axis, an encoder each.

    They are the only ones, and nothing else is named after the axis of either, so that what drives is that axis'.
    Joints, wheels and sides are parts of their own, however alike they move.
    """
    places = [p for p, (signal, _) in placed.items() if signal == "position"]
    axes = [placed[p][1] for p in places]
    others = {axis for p, (_, axis) in placed.items() if p not in places}
    if len(places) != 2 or axes[0] == axes[1] or others & set(axes):
        return placed
    if any(set(words_of(bare(name))) & MEMBERS for name, _ in places):
        return placed
    x, y = (values_of(p, tables) for p in places)
    if len(x) != len(y) or not (moves(x) and moves(y)) or abs(np.corrcoef(x, y)[0, 1]) < TOGETHER:
        return placed
    first, second = (name for name, _ in places)
    guesses.append(f"{first!r} and {second!r} are two encoders of one axis, because they move together")
    return {**placed, places[1]: ("load", axes[0])}


def _same(place: Place, other: Place, tables: Tables) -> bool:
    """Return whether two columns that move are one reading, each in a unit that its name states."""
    units = [parse(p[0]).unit for p in (place, other)]
    if None in units or units[0] == units[1]:
        return False
    x, y = (values_of(p, tables) * UNITS[str(unit)] for p, unit in zip((place, other), units, strict=True))
    return len(x) == len(y) and bool(np.ptp(x) > 0.0 and np.ptp(x - y) < ROUNDED * np.ptp(x))


def _rank(place: Place, table: str) -> tuple[bool, bool, int, bool]:
    """Return what orders columns for one signal, the least first: in the table, measured, not made of another, and of
    what is asked for a place.
    """
    words = set(words_of(place[0]))
    made = bool(words & DERIVED) + 2 * bool(words & MODELLED)
    vague = bool(words & ASKED) and not words & (POSITION | VELOCITY)
    return bool(table) and table_of(place[0]) != table, not words & MEASURED, made, vague


def _home(axis: str, groups: Mapping[str, Any]) -> str | None:
    """Return the axis that a signal of another name belongs to; None where there is none, or more than one."""
    if len(groups) == 1:
        return next(iter(groups))
    words = set(axis.split("_"))
    fits = [x for x in groups if (axis and x and (words <= set(x.split("_")) or set(x.split("_")) <= words))]
    number = re.search(r"\d+$", axis)
    fits = fits or [x for x in groups if number and re.search(r"(?<!\d)" + number[0] + "$", x)]
    return fits[0] if len(fits) == 1 else None
