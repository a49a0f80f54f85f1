"""A description drafted from a file, whatever kind of machine its columns speak of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from sher3_common import parse_yaml

from sher3_machines.drafting.draft import draft, written
from sher3_machines.drafting.unnamed import (
    Place,
    as_recorded,
    clock_among,
    given,
    named_by_motion,
    place_text,
    places_of,
    renamed,
)
from sher3_machines.errors import MachineError
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.kinds import kinds
from sher3_machines.intake.runs import longest
from sher3_machines.intake.tables import Tables

FEWEST = 3
"""Rows that a record or a table has at least: of two nothing shows whether one of them is wrong."""


def draft_of(path: Path, rate: float | None = None, model: Path | None = None, names: Sequence[str] = ()) -> Draft:
    """Draft what the first kind that knows the file makes of it, else a chain of axes.

    Args:
        path: of the data.
        rate: samples per second, Hz, where no time was recorded.
        model: URDF or MJCF of the arm whose joints were recorded.
        names: of the columns in their order, where the file has none.

    Raises:
        MachineError: the file cannot be read or holds next to nothing, or no column looks like a time or a position.
    """
    tables = longest(path)
    rows = max(map(len, tables.values()), default=0)
    if rows < FEWEST:
        raise MachineError(
            f"{path.name}: too few rows", value=rows, limit=FEWEST, remedy="give the file of the samples"
        )
    if names:
        return _draft_named(path, tables, rate, model, given(names, tables), [])
    try:
        return _draft(path, tables, rate, model)
    except MachineError as refused:
        guesses: list[str] = []
        found = named_by_motion(tables, rate, guesses)
        if not found and (clock := clock_among(tables)):
            raise MachineError(
                f"{path.name}: no column looks like a position",
                value=", ".join(map(place_text, places_of(tables))),
                limit=f"one that follows another one, or is the integral of one; {clock} is the time",
                remedy="name the columns in order, an empty one for what is no signal: --names t,q,,u",
            ) from refused
        if not found:
            raise
        return _draft_named(path, tables, rate, model, found, guesses)


def _draft(path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft:
    drafts = (kind.draft(path, tables, rate, model) for kind in kinds().values())
    return next((found for found in drafts if found is not None), None) or draft(path, rate, tables)


def _draft_named(
    path: Path, tables: Tables, rate: float | None, model: Path | None, names: Mapping[Place, str], guesses: list[str]
) -> Draft:
    """Return the draft of columns that were named, in the words of the file."""
    found = _draft(path, renamed(names, tables), rate, model)
    return written(as_recorded(parse_yaml(found.text), names), [*guesses, *found.guesses])
