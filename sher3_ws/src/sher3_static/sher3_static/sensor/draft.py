"""A force sensor drafted from a table without a clock: three forces, three torques and how the sensor was turned."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sher3_machines.drafting.draft import name_of, unused_columns, written
from sher3_machines.drafting.names import ASKED, bare_and_unit, tells_time, words_of
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables

PARTS: Mapping[str, tuple[str, str, str]] = {
    "force": (r"f|forces?", "xyz", "N"),
    "torque": (r"t|m|torques?|moments?", "xyz", "N*m"),
    "quaternion": (r"q|quat|quaternion|orientation", "xyzw", "1"),
}
"""Quantity -> how it is called before the letter, or the number, of its component; these letters; its unit."""


def wrench_of(tables: Tables) -> dict[str, list[str]]:
    """Return the columns of force, torque and orientation, those of which every component is there, in their order.

    What was measured comes before what was asked for, such as the goal of a pose.
    """
    plain = {bare_and_unit(bare(n))[0].lower(): n for n, x in tables.items() if x.ndim == 1}
    plain = dict(sorted(plain.items(), key=lambda item: not set(words_of(item[0])) & ASKED))
    found = {}
    for part, (stem, letters, _) in PARTS.items():
        each = {}
        for name, column in plain.items():
            if match := re.fullmatch(rf"(?:.*[_/ ])?(?:{stem})[_ ]?([{letters}]|\d)", name):
                each[match[1]] = column
        numbers = sorted(k for k in each if k.isdigit())
        order = list(letters) if set(letters) <= each.keys() else numbers
        if len(order) == len(letters):
            found[part] = [each[k] for k in order]
    return found


def draft_sensor(path: Path, tables: Tables) -> Draft | None:
    """Draft the description of a force sensor; None of a table with a clock, or without one of the three quantities.

    Args:
        path: of the data, for the name.
        tables: what it holds.
    """
    found = wrench_of(tables)
    if found.keys() != PARTS.keys() or any(tells_time(n) for n in tables):
        return None
    guesses = [f"a force sensor: {part} is {', '.join(columns)}" for part, columns in found.items()]
    each: dict[str, Any] = {p: [_column(n, PARTS[p][2], guesses) for n in columns] for p, columns in found.items()}
    data: dict[str, Any] = {"kind": "force_sensor", "name": name_of(path)}
    data |= {"force": each["force"], "torque": each["torque"], "orientation": {"quaternion": each["quaternion"]}}
    guesses.append(
        "what hangs on it is found from the readings, and a wrong scale of the sensor is then not told: state "
        "`load: {mass: kg, centre: [m, m, m]}`"
    )
    return written(data, [*guesses, *unused_columns(tables, [n for columns in found.values() for n in columns])])


def _column(name: str, unit: str, guesses: list[str]) -> dict[str, str]:
    """Return a column in the unit that its name says, else in the usual one."""
    said = bare_and_unit(bare(name))[1]
    if said is None and unit != "1" and (text := "forces in N, torques in N*m, because no name says so") not in guesses:
        guesses.append(text)
    return {"column": name, "unit": said or unit}
