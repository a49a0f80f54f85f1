"""From rows of cells, as a spreadsheet or a text file has them, to named arrays of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.fields import TIME_UNITS
from sher3_machines.intake.readers.cells import value_of
from sher3_machines.intake.readers.long import machines_of
from sher3_machines.intake.units import UNITS, spelled

MOST_TITLES = 50
"""Lines of text above a table at most."""
FILLED = 0.5
"""Share of the numbers of a usual row beyond which a row belongs to the table and no longer to its titles."""
SETTINGS = 6
"""Rows between a header and the first one that is full of numbers, from which they are settings."""
LONGEST_UNIT = 10
"""Letters of a unit at most."""
FEW = 0.02
"""Share of the cells of a column that may be text, such as `ERR`, a remark, or a line that ends the file."""

FILETIMES = 1.2e17, 1.7e17
"""Stamps of Windows of the years 1981 to 2139."""
BEFORE_1970 = 11_644_473_600.0
"""Seconds from 1601 to 1970."""

Rows = Sequence[Sequence[str]]


def columns_of(rows: Rows, comma: bool, names: Sequence[str] = ()) -> dict[str, Array]:
    """Return the numeric columns (rows,) of rows of cells; without a header columns are c0, c1, ...

    Args:
        rows: cells as text, titles and header among them.
        comma: whether a comma is the decimal mark.
        names: of the columns, where they stand outside of the rows and the rows have no header.

    Of columns of one name the second is `NAME.2`; loggers write the stamps of each channel again: those are left out.
    Of several tables, one below the other with a header each, the columns stand side by side.
    """
    rows = _without_settings(rows[_titles(rows, comma) :], comma)
    below = _second_header(rows, comma)
    if below is not None and rows[0] == rows[below]:  # one log that was begun again
        return columns_of([row for row in rows if row != rows[0] or row is rows[0]], comma, names)
    first = _one_table(rows[:below], comma, names)
    return first if below is None else _beside(first, columns_of(rows[below:], comma))


def _second_header(rows: Rows, comma: bool) -> int | None:
    """Return the row that is the header of a further table: words, in the columns of the numbers below it."""
    usual = rows[usual_row(len(rows))]
    first = next((i for i, cell in enumerate(usual) if _is_number(cell, comma)), None)
    if first is None or any(_is_number(cell, comma) for cell in rows[0]):
        return None
    words = (i for i, row in enumerate(rows[:-1]) if i > 1 and first < len(row) and not _is_number(row[first], comma))
    return next((i for i in words if _is_header(rows[i], rows[i + 1], comma)), None)


def _is_header(row: Sequence[str], after: Sequence[str], comma: bool) -> bool:
    """Return whether a row holds several words and no number, and the row after it numbers in the same columns."""
    words = {i for i, cell in enumerate(row) if _filled(cell)}
    numbers = {i for i, cell in enumerate(after) if _is_number(cell, comma)}
    return len(words) > 1 and words == numbers and not any(_is_number(row[i], comma) for i in words)


def _beside(first: dict[str, Array], more: dict[str, Array]) -> dict[str, Array]:
    """Return the columns of two tables; a column that both have is one, or of another name where it differs."""
    out = dict(first)
    for name, x in more.items():
        same = [known for known in out if known == name or known.startswith(f"{name}.")]
        if not any(np.array_equal(out[known], x, equal_nan=True) for known in same):
            out[f"{name}.{len(same) + 1}" if same else name] = x
    return out


def _one_table(rows: Rows, comma: bool, names: Sequence[str]) -> dict[str, Array]:
    """Return the numeric columns of rows below a header, or without one: words beside numbers make no header."""
    numeric = [i for i, cell in enumerate(rows[usual_row(len(rows))]) if _is_number(cell, comma)]
    beside = bool(numeric) and all(i < len(rows[0]) and _is_number(rows[0][i], comma) for i in numeric)
    if numeric and numeric[-1] >= len(rows[0]) > 1 and not beside:  # which of the titles is missing, nobody can tell
        return _one_table([[f"c{i}" for i in range(numeric[-1] + 1)], *rows[1:]], comma, names)
    if beside or all(value_of(cell, comma) is not None for cell in rows[0]):
        header = list(names) if len(names) == len(rows[0]) else [f"c{i}" for i in range(len(rows[0]))]
    else:
        header, rows = [cell.strip() for cell in rows[0]], rows[1:]
    header = _with_strokes(header)
    if rows and _are_units(rows[0]):
        header, rows = _with_units(header, rows[0]), rows[1:]
    if header[0] != "c0" and (parts := machines_of(rows, comma)):
        return {f"{part}/{n}": x for part, own in parts.items() for n, x in _numeric(header, own, comma).items()}
    return _numeric(header, rows, comma)


def _numeric(header: Sequence[str], rows: Rows, comma: bool) -> dict[str, Array]:
    """Return the numeric columns (rows,) below the names of a header."""
    out: dict[str, Array] = {}
    for i, name in enumerate(header):
        x = _dated(_column([row[i] if i < len(row) else "" for row in rows], comma))
        same = [known for known in out if known == name or known.startswith(f"{name}.")] if name in header[:i] else []
        nothing = name in ("", f"c{i}") and x is not None and bool(np.isnan(x).all())  # cells that fill a row up
        if x is not None and not nothing and not any(np.array_equal(out[known], x, equal_nan=True) for known in same):
            out[f"{name}.{len(same) + 1}" if same else name] = x
    return out


def usual_row(rows: int) -> int:
    """Return the row that is taken for a usual one: in the third quarter, below all titles and above the last line."""
    return min(3 * rows // 4, max(rows - 2, rows // 2))


def _titles(rows: Rows, comma: bool) -> int:
    """Return how many rows of text stand above the header.

    The header is the row above the numbers whose filled cells are most nearly those that the numbers fill, of several
    the first that is as wide and holds no number: units stand below it. A spreadsheet fills the lines above its table
    up with empty cells, so that they are as wide as the table; a logger of drives writes settings there that are wider,
    and are no header of it. Columns that never change, strokes between blocks among them, need no title.
    """
    usual = rows[usual_row(len(rows))]
    numeric = [i for i, cell in enumerate(usual) if _is_number(cell, comma)]
    first = next((i for i, row in enumerate(rows) if _in_table(row, numeric, len(usual), comma)), 0)
    if not 0 < first <= MOST_TITLES:
        return 0
    filled: set[int] = set()
    changing: set[int] = set()
    for row in rows[first:]:
        filled |= {i for i in range(len(row)) if i not in filled and _filled(row[i])}
        changing |= {i for i in numeric if i not in changing and i < len(row) and row[i] != usual[i]}
    above = [{i for i, cell in enumerate(row) if _filled(cell)} for row in rows[:first]]
    if _known_units(rows[first - 1]) and first > 1 and len(rows[first - 2]) == len(rows[first - 1]):
        return first - 2
    fits = [len(row & filled) - len(row - filled) for row in above]
    words = [len(row) == len(usual) and not any(_is_number(cell, comma) for cell in row) for row in rows[:first]]
    header = max(range(first), key=lambda i: (fits[i], words[i]))
    titled = 2 * fits[header] > len(filled) or 2 * len(above[header] & changing) > len(changing)
    return header if titled else len(above)


def names_of(preamble: Rows) -> list[str]:
    """Return the names in the last row of a preamble; where that holds units, those of the row above it with them."""
    if not preamble:
        return []
    above, last = preamble[-2:] if len(preamble) > 1 else ([], preamble[-1])
    units = [spelled(cell.strip().strip("[]()")) for cell in last]
    has_units = len(above) == len(last) and 2 * sum(unit in UNITS for unit in units) > len(last)
    return _with_units(above, last) if has_units else list(last)


def _without_settings(rows: Rows, comma: bool) -> Rows:
    """Return a header with its table, without rows of settings between, which have words where the table has numbers.

    Units and remarks below a header are few.
    """
    usual = rows[usual_row(len(rows))]
    numeric = [i for i, cell in enumerate(usual) if _is_number(cell, comma)]
    numbers = (i for i, row in enumerate(rows) if all(i < len(row) and _is_number(row[i], comma) for i in numeric))
    first = next(numbers, 0)
    return rows if first < SETTINGS or first > MOST_TITLES else [rows[0], *rows[first:]]


def _in_table(row: Sequence[str], numeric: Sequence[int], width: int, comma: bool) -> bool:
    """Return whether a row holds numbers where a usual one does, in more than half of those columns."""
    filled = sum(i < len(row) and _is_number(row[i], comma) for i in numeric)
    return len(row) <= width and filled > FILLED * len(numeric)


def _is_number(cell: str, comma: bool) -> bool:
    return _filled(cell) and value_of(cell, comma) is not None


def _filled(cell: str) -> bool:
    return bool(cell.strip())


def _known_units(row: Sequence[str]) -> bool:
    """Return whether every cell of a row that is filled is a unit."""
    units = [spelled(cell.strip().strip("[]()")) for cell in row if _filled(cell)]
    return bool(units) and all(unit in UNITS for unit in units)


def _are_units(row: Sequence[str]) -> bool:
    """Return whether a row below the header holds units: words where numbers should be, none of them long."""
    cells = [cell.strip() for cell in row]
    return (
        any(cells) and all(value_of(c, True) is None or not c for c in cells) and max(map(len, cells)) <= LONGEST_UNIT
    )


def _with_units(header: Sequence[str], units: Sequence[str]) -> list[str]:
    """Return the names of the columns with the units of the row below, as headers have them.

    A column without a name whose unit is that of a time is the time.
    """
    cells = [*(u.strip().strip("[]()") for u in units), *[""] * len(header)]
    cells = ["" if unit == "#" else unit for unit in cells]  # a number of something has no unit
    names = [name or ("time" if spelled(unit) in TIME_UNITS else "") for name, unit in zip(header, cells, strict=False)]
    return [f"{name} [{unit}]" if unit else name for name, unit in zip(names, cells, strict=False)]


def _with_strokes(header: Sequence[str]) -> list[str]:
    """Return names with units behind a stroke, `Angle/rad` (ISO 80000-1), as `Angle [rad]`.

    Where a stroke of the header parts no unit, strokes part tables.
    """
    parted = [name.partition("/") for name in header]
    if not all(name and spelled(unit) in UNITS for name, stroke, unit in parted if stroke):
        return list(header)
    return [f"{name} [{unit}]" if stroke else name for name, stroke, unit in parted]


def _dated(x: Array | None) -> Array | None:
    """Return stamps of Windows, 100 ns since 1601, as seconds since 1970; no other column counts as far."""
    if x is None or x.ndim > 1 or not FILETIMES[0] < np.nanmax(x, initial=0.0) < FILETIMES[1]:
        return x
    return 1e-7 * x - BEFORE_1970


def _column(cells: Sequence[str], comma: bool) -> Array | None:
    """Cells as (n,) or, where they hold lists, (n, k); None where more than a few are text, which become nan."""
    with suppress(ValueError):  # numbers alone, as most columns are
        return np.array([float(cell.replace(",", ".") if comma else cell) for cell in cells])
    values = [value_of(cell, comma) for cell in cells]
    text = sum(value is None for value in values)
    if text > FEW * len(values):
        return None
    width = max((len(value) for value in values if isinstance(value, list)), default=0)
    nothing = [float("nan")] * width if width else float("nan")
    blank = [value is None or (width and not isinstance(value, list) and value != value) for value in values]
    values = [nothing if none else value for value, none in zip(values, blank, strict=True)]  # type: ignore[misc]
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError):
        return None
