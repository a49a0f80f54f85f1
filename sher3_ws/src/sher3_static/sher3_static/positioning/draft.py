"""A positioning test drafted from a table: which column is the target, the reading, the cycle, the side, the warmth.

The words are those of ISO 230-2 protocols. There the reference is the instrument that reads where the axis stands, and
not what it was asked for.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.drafting.draft import ROTARY_UNITS, name_of, unused_columns, written
from sher3_machines.drafting.guesses import WIDEST_ROOM, reach
from sher3_machines.drafting.names import (
    ASKED,
    IGNORED,
    MEASURED,
    POSITION,
    SECOND,
    TEMPERATURE,
    VELOCITY,
    bare_and_unit,
    tells_time,
    vocabulary,
    words_of,
)
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables

TARGET = ASKED - vocabulary("ref reference d cmd command") | vocabulary("nominal sollposition zielposition ziel")
READING = MEASURED | SECOND | vocabulary("ref reference reading istposition istwert gemessen") - vocabulary("load link")
DEVIATION = vocabulary("deviation deviations dev error err abweichung")
CYCLE = vocabulary("cycle cycles zyklus run lauf repeat")
SIDE = vocabulary("direction dir approach side richtung anfahrrichtung")
UP, DOWN = vocabulary("up auf hin forward plus"), vocabulary("down ab zurück backward minus")
PASS = UP | DOWN | {"pass"}
REPEATED = 2.0
"""Rows for each target from which a table is a test that was repeated, and no record."""
FEWEST = 8
"""Rows, or rows times passes, that a test has at least."""
ALIKE = 0.999
"""Correlation of target and reading from which the second one reads the first."""
SMALL = 1e-3
"""Deviation over the travel, of one without a unit, from which it is hardly in the unit of the target, but in um."""
NEAR = 0.05
"""How near to a scale that of a reading must be."""
SCALES = (1.0, 1e3, 1e-3, 1e6, 1e-6)
"""A reading over its target, where one is in m, mm or um: a deviation in proportion to the target is a lead error."""


def draft_test(path: Path, tables: Tables) -> Draft | None:
    """Draft the description of a positioning test of one axis; None of a table without targets and readings.

    A clock makes a table a record, unless a cycle or a side of approach is told.

    Args:
        path: of the data, for the name.
        tables: what it holds.
    """
    flat = {n: x for n, x in tables.items() if x.ndim == 1}
    of_a_test = one(flat, CYCLE) is not None or one(flat, SIDE) is not None
    found = None if any(tells_time(n) for n in flat) and not of_a_test else _columns(flat)
    if found is None:
        return None
    target, read = found
    guesses = [
        "a positioning test: a table of targets and readings, as ISO 230-2 has it; a record in time needs a column "
        "named t, time or stamp"
    ]
    unit, why = _unit(target, flat[target])
    guesses.append(f"targets are {target!r}, in {unit}, because {why}; write deg for a table that turns")
    axis: dict[str, Any] = {"name": "axis", "motion": "rotary" if unit in ROTARY_UNITS else "linear"}
    axis["target"] = {"column": target, "unit": unit}
    axis.update(_read(read, flat, target, unit, guesses))
    used = {target, *read}
    if "passes" not in axis:
        for key, words in (("direction", SIDE), ("cycle", CYCLE)):
            name = one(flat, words, used)
            if name is not None:
                axis[key] = {"column": name, "unit": "1"}
                used.add(name)
                guesses.append(f"{key} is {name!r}, because of its name")
            else:
                guesses.append(f"{key} from the order of the rows: no column of numbers is named so")
    warm = one(flat, TEMPERATURE, used)
    if warm is not None:
        axis["temperature"] = {"column": warm, "unit": "degC"}
        used.add(warm)
        guesses.append(f"temperature is {warm!r}, because of its name")
    data = {"kind": "positioning", "name": name_of(path), "axes": [axis]}
    return written(data, [*guesses, *unused_columns(tables, used)])


def one(flat: Tables, words: Collection[str], used: Collection[str] = ()) -> str | None:
    """Return the first column with one of some words in its name that is not used."""
    return next((n for n in flat if n not in used and words_in(n) & set(words)), None)


def words_in(column: str) -> set[str]:
    """Return the words of a column's name without its unit."""
    return set(words_of(bare_and_unit(bare(column))[0]))


def _columns(flat: Tables) -> tuple[str, list[str]] | None:
    """Return the target, and the reading, the deviation or the passes; None where the table has no such."""
    targets = [n for n in flat if words_in(n) & TARGET and not words_in(n) & (DEVIATION | MEASURED | VELOCITY)]
    for target in targets:
        x = flat[target]
        others = {
            n: y for n, y in flat.items() if n != target and len(y) == len(x) and not words_in(n) & IGNORED - DEVIATION
        }
        passes = [n for n, y in others.items() if words_in(n) & PASS and _small(y, x)]
        if len(passes) > 1 and len(passes) * len(x) >= FEWEST:
            return target, in_turn(passes)
        if len(x) < FEWEST or len(x) < REPEATED * len(np.unique(x)):
            continue
        off = [n for n, y in others.items() if words_in(n) & DEVIATION and _small(y, x)]
        read = [
            n for n, y in others.items() if words_in(n) & (READING | POSITION) and np.ptp(y) > 0.0 and _follows(y, x)
        ]
        if read or off:
            return target, (read or off)[:1]
    return None


def in_turn(passes: list[str]) -> list[str]:
    """Return passes in the order of a protocol, from below and from above in turn, where their names say both."""
    sides = [int(bool(words_in(n) & DOWN)) for n in passes]
    numbers = [re.findall(r"\d+", bare_and_unit(n)[0]) for n in passes]
    if len(set(sides)) == 1 or not all(numbers):
        return passes
    order = sorted(range(len(passes)), key=lambda i: (int(numbers[i][-1]), sides[i]))
    return [passes[i] for i in order]


def _follows(y: Array, x: Array) -> bool:
    """Whether a column (n,) moves as the target (n,) does, in its unit or another one of length."""
    if not np.ptp(x) > 0.0 or np.corrcoef(x, y)[0, 1] < ALIKE:
        return False
    scale = float(np.ptp(y) / np.ptp(x))
    return any(abs(scale / known - 1.0) < NEAR for known in SCALES)


def _small(y: Array, x: Array) -> bool:
    """Whether a column is no place: it does not follow the target."""
    return not (np.ptp(y) > 0.0 and _follows(y, x))


def _unit(name: str, x: Array) -> tuple[str, str]:
    unit = bare_and_unit(name)[1]
    if unit is not None:
        return unit, "its name says so"
    return ("mm" if reach(x) > WIDEST_ROOM else "m"), f"values reach {reach(x):.4g}"


def _read(read: list[str], flat: Tables, target: str, unit: str, guesses: list[str]) -> dict[str, Any]:
    """Return the reading, the deviation or the passes of a test; a deviation without a unit is guessed by its size."""
    place = not _small(flat[read[0]], flat[target])
    columns = []
    for name in read:
        own = bare_and_unit(name)[1]
        large = float(np.abs(flat[name]).max()) > SMALL * float(np.ptp(flat[target]))
        columns.append({"column": name, "unit": own or (unit if place or not large else "um")})
    key = "reading" if place else "passes" if len(read) > 1 else "deviation"
    guesses.append(f"{key}: {', '.join(read)} in {columns[0]['unit']}, because of the names and values")
    return {key: columns if key == "passes" else columns[0]}
