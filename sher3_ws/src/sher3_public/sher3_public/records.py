"""Records as people hold them, arrays or a table with names, brought to columns."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sher3_public.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Arrays:
    """One run of k joints, n samples.

    Attributes:
        time: (n,), s.
        position: (n, k), rad or m.
        control: (n, m), one column for each actuator of the model or each joint; None: not recorded.
        effort: (n, k), N m or N; None: not recorded.
        load: (n, k), second encoders behind the gears, rad or m; None: none.
    """

    time: Array
    position: Array
    control: Array | None = None
    effort: Array | None = None
    load: Array | None = None


def is_table(record: object) -> bool:
    """Return whether a record is a table with names: a mapping, a structured array, a frame of pandas or Polars."""
    named = isinstance(record, np.ndarray) and record.dtype.names is not None
    return named or isinstance(record, Mapping) or (hasattr(record, "columns") and hasattr(record, "__getitem__"))


def tables_at(record: object) -> Any:
    """Return the tables of a log by its path, or of several, one for each run; a list of samples by name as one table.

    Other records stay as they are.

    Raises:
        MachineError: no such file, no known format, or a table that cannot be read.
    """
    given: list[Any] = list(record) if isinstance(record, list | tuple) else [record]
    if given and all(isinstance(x, Mapping) and all(np.ndim(v) == 0 for v in x.values()) for x in given):
        return {name: [row.get(name, np.nan) for row in given] for name in given[0]}  # one mapping for each sample
    paths = [Path(x) for x in given if isinstance(x, str | PathLike)]
    if not paths or len(paths) < len(given):
        return record
    from sher3_machines.intake.runs import runs_of

    return list(runs_of(paths).values())


def columns_of(table: Any) -> dict[str, Array]:
    """Return the columns (n, ...) of a table by name, times in s, an index of stamps as the time, texts left out."""
    array = isinstance(table, np.ndarray)
    names = table.dtype.names if array else list(table) if isinstance(table, Mapping) else list(table.columns)
    found = {_flat_name(name): _as_numbers(table[name]) for name in names}
    index = np.asarray(getattr(table, "index", [])) if not isinstance(table, Mapping) else np.array([])
    if index.dtype.kind in STAMPS and not any(name.lower() in CLOCKS for name in found):
        found["time"] = index
    columns = {name: _numbers(name, x) for name, x in found.items() if x.dtype.kind in STAMPS + "iu"}
    _check_lengths(columns)
    return columns


def _flat_name(name: object) -> str:
    """Return the name of a column as one text; those of several levels are joined."""
    return "_".join(str(x) for x in name if x) if isinstance(name, tuple) else str(name)


def _check_lengths(columns: Mapping[str, Array]) -> None:
    """Raise InputError where a column has a few rows more or less than the only clock of the table."""
    clocks = [name for name in columns if name.lower() in CLOCKS]
    for name, x in columns.items() if len(clocks) == 1 else ():
        rows = len(columns[clocks[0]])
        if x.ndim and 0 < abs(len(x) - rows) < FEW * rows:
            remedy = "give one row for each stamp"
            raise InputError(f"{name} and {clocks[0]} differ in length", value=len(x), limit=rows, remedy=remedy)


def _as_numbers(column: Any) -> NDArray[Any]:
    """Return a column as it is, or as numbers where it holds objects that are some, such as those of pandas."""
    found = np.asarray(column)
    try:
        return np.asarray(column, dtype=float) if found.dtype.kind == "O" else found
    except (TypeError, ValueError):
        return found


CLOCKS = ("t", "time", "stamp", "timestamp")
"""Names of a table's own stamps."""
FEW = 0.1
"""Share of a table's rows by which a column may differ that was meant to have as many; others are no columns of it."""
STAMPS = "Mmf"
"""Kinds of array that stamps may be: moments, spans of time, numbers with a fraction; counts of rows are none."""


def columns_named(table: Mapping[str, Array], names: Sequence[str]) -> Array | None:
    """Return the columns (n, k) of the first name that a table has: an array of it, or `name1`, `name_2`, `name[3]`."""
    for name in names:
        numbered = {int(m[1]): x for n, x in table.items() if (m := re.fullmatch(rf"{name}[_.\[]?(\d+)\]?", n))}
        found = table.get(name, np.column_stack([numbered[i] for i in sorted(numbered)]) if numbered else None)
        if found is not None:
            return found[:, None] if found.ndim == 1 else found
    return None


def arrays_of(time: Any, control: Any, position: Any, effort: Any, load: Any) -> list[Arrays]:
    """Return the runs: each argument is an array (n,) or (n, k), or a list of such arrays, one for each run.

    Raises:
        InputError: lists differ in length, or arrays in their number of samples; time or position is missing, or an
            array holds no numbers.
    """
    given = {"time": time, "control": control, "position": position, "effort": effort, "load": load}
    several = {name: list(x) for name, x in given.items() if is_several(x)}
    counts = {name: len(x) for name, x in several.items()}
    if len(set(counts.values())) > 1 or (several and any(x is not None and n not in several for n, x in given.items())):
        each = ", ".join(f"{name} {counts.get(name, 'one array')}" for name, x in given.items() if x is not None)
        raise InputError("arguments differ in their number of runs", value=each, remedy="give each a list of arrays")
    runs = next(iter(counts.values()), 1)
    return [_run({name: several[name][i] if name in several else x for name, x in given.items()}) for i in range(runs)]


def is_several(x: object) -> bool:
    """Return whether an argument is a list of runs: a list or tuple whose entries are arrays or tables themselves."""
    return (
        isinstance(x, list | tuple) and bool(x) and all(is_table(e) or (hasattr(e, "__len__") and _long(e)) for e in x)
    )


def _long(x: Any) -> bool:
    """Return whether an entry of a list is a run, not the joints of one sample: a run has more samples than joints."""
    return len(x) >= LEAST


LEAST = 20
"""Samples of a run at least, as the diagnosis asks for them."""


def _run(given: Mapping[str, Any]) -> Arrays:
    for name in ("time", "position"):
        if given[name] is None:
            raise InputError(f"{name} is missing", remedy="give time (n,) and position (n, k)")
    time = _numbers("time", given["time"])
    if not time.size:
        raise InputError("time has no stamps", value=time.shape, remedy="give time (n,) and position (n, k)")
    if time.ndim != 1:
        raise InputError("time is no single column", value=time.shape, limit="(n,)", remedy="give stamps in s")
    wide = {name: _columns(name, given[name], len(time)) for name in ("position", "control", "effort", "load")}
    position = wide.pop("position")
    assert position is not None
    return Arrays(time, position, **wide)


def _numbers(name: str, x: ArrayLike) -> Array:
    """Return an array of numbers; times and spans of time as NumPy has them are brought to s, from the first."""
    try:
        found = np.asarray(x)
        if found.dtype.kind in "Mm":
            return (found - found[0] if found.dtype.kind == "M" else found) / np.timedelta64(1, "s")
        if found.dtype.kind in "bc":
            raise TypeError(str(found.dtype))
        return np.asarray(x, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is no array of numbers", value=str(error)[:80], remedy="give numbers") from error


def _columns(name: str, x: ArrayLike | None, samples: int) -> Array | None:
    """Return an array (n, k); (n,) is one column."""
    if x is None:
        return None
    found = _numbers(name, x)
    found = found[:, None] if found.ndim == 1 else found
    if found.ndim != 2 or len(found) != samples:
        remedy = "give one row for each stamp"
        raise InputError(f"{name} and time differ in length", value=found.shape, limit=f"({samples}, k)", remedy=remedy)
    return found


def per_run(
    tags: Mapping[str, Sequence[object]] | Sequence[Mapping[str, object]] | None, runs: int
) -> list[dict[str, Any]]:
    """Return the tags of each run; raises InputError where there are not as many values as runs."""
    if tags is None:
        return []
    if isinstance(tags, Mapping):
        for tag, values in tags.items():
            if isinstance(values, str) or len(values) != runs:
                raise InputError(
                    f"tag {tag} has not one value for each run",
                    value=values,
                    limit=f"{runs} runs",
                    remedy="give a value for each run",
                )
        return [{tag: values[i] for tag, values in tags.items()} for i in range(runs)]
    if len(tags) != runs:
        raise InputError(
            "tags are not as many as runs", value=len(tags), limit=f"{runs} runs", remedy="give a value for each run"
        )
    return [dict(x) for x in tags]
