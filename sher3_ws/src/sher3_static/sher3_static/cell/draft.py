"""A load cell drafted from a table: which column is the known load, in which unit, and which one follows it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.drafting.draft import name_of, unused_columns, written
from sher3_machines.drafting.names import bare_and_unit, counts_samples, parse, tells_time, vocabulary, words_of
from sher3_machines.intake.fields import Column
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables

from sher3_static.readings import LACKING, as_weight
from sher3_static.sensor.draft import wrench_of

STATED = vocabulary("applied known weight weights mass masses reference ref true truth gewicht gewichte masse")
"""Words for what is laid on a cell."""
FORCE = vocabulary("force load torque kraft last drehmoment")
"""Words for it that a reading may have as well."""
LOADS = ("N", "kN", "mN", "N*m", "mN*m", "kg", "gf", "kgf", "lbf")
"""Units of a known load."""
FOLLOWS = 0.95
"""Correlation of load and reading from which the second one reads the first: single readings scatter by a tenth."""
FEWEST, LEVELS = 8, 3
"""Rows of a table, and different loads, at least."""
PLACES = ("position", "reference", "velocity", "temperature")
"""Signals that are no reading of a cell: a spring's travel follows its force too."""


def loads_of(tables: Tables) -> tuple[str, str] | None:
    """Return the columns of known load and reading of a table without a time; None where it has no such.

    A reading is called otherwise than the loads, where one follows them. Of several columns for either, as the load
    that was meant and the one that was laid on, those two are taken that go together best, in a unit where one has it.
    """
    flat = {n: x for n, x in tables.items() if x.ndim == 1 and len(x) and np.isfinite(x).mean() >= 1.0 - LACKING}
    if any(tells_time(n) for n in tables) or {"force", "torque"} <= wrench_of(tables).keys():
        return None
    moved = any(parse(n).signal in ("position", "velocity") and np.ptp(x) > 0.0 for n, x in flat.items())
    known = (STATED,) if moved else (STATED, FORCE)  # a force beside travel is what a spring or a motor gave
    called = [[n for n in flat if words & set(words_of(bare_and_unit(bare(n))[0]))] for words in known]
    reads = [n for n in flat if parse(n).signal not in PLACES and not counts_samples(n)]
    for loads in called:
        pairs = [(load, n) for load in loads for n in reads if n != load and _likeness(flat[load], flat[n]) > FOLLOWS]
        apart = [pair for pair in pairs if not any(pair[1] in names for names in called)] or pairs
        if apart:
            return max(apart, key=lambda pair: (_unit_of(pair[0]) in LOADS, _likeness(flat[pair[0]], flat[pair[1]])))
    return None


def draft_cell(path: Path, tables: Tables) -> Draft | None:
    """Draft the description of a load cell; None of a table without known loads and what read them.

    Args:
        path: of the data, for the name.
        tables: what it holds.
    """
    found = loads_of(tables)
    if found is None:
        return None
    load, read = found
    guesses = ["a load cell: a table of known loads and what was read; a record in time needs a column named t or time"]
    said = _unit_of(load)
    said = said if said in LOADS else None
    turned = vocabulary("torque drehmoment") & set(words_of(bare(load)))
    applied = Column(column=load, unit=said or ("N*m" if turned else "N"))
    why = "its name says so" if said else "nobody states it"
    guesses.append(f"loads are {load!r}, in {applied.unit}, because {why}")
    x, y = _both(as_weight(applied) * applied.scale * tables[load], tables[read])
    reading = {"column": read, **_scaled(read, x, y, guesses)}
    guesses += unused_columns(tables, found)
    measures = "torque" if str(applied.unit).endswith("N*m") else "force"
    data: dict[str, Any] = {"kind": "load_cell", "name": name_of(path), "measures": measures}
    data["applied"] = {"column": load, "unit": applied.unit}
    data["reading"] = reading
    return written(data, guesses)


def _scaled(read: str, x: Array, y: Array, guesses: list[str]) -> dict[str, Any]:
    """Return the unit of a reading (n,) of loads (n,): its own where its name states that of a load, else a slope."""
    unit = _unit_of(read)
    if unit in LOADS:
        guesses.append(f"the reading is {read!r}, in {unit}, because its name says so")
        return {"unit": unit}
    guesses.append(f"the reading is {read!r}; its `factor` is the slope of this table: state that of the data sheet")
    return {"unit": "1", "factor": float(f"{np.polyfit(y, x, 1)[0]:.6g}"), "override": True}


def _unit_of(column: str) -> str | None:
    return bare_and_unit(bare(column))[1]


def _both(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the rows of two columns that have both numbers."""
    known = np.isfinite(x) & np.isfinite(y)
    return x[known], y[known]


def _likeness(x: Array, y: Array) -> float:
    """Return the correlation of two columns without its sign, of enough different loads; else 0."""
    if not len(x) == len(y) >= FEWEST:
        return 0.0
    x, y = _both(x, y)
    return abs(float(np.corrcoef(x, y)[0, 1])) if len(np.unique(x)) >= LEVELS and np.ptp(y) > 0.0 else 0.0
