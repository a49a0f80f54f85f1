"""Tables as text: commas, semicolons, tabs or blanks; decimal points or commas; ISO times; units in the header."""

from __future__ import annotations

import csv
import re
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from sher3_common import FileError, parse_json, read_bytes
from sher3_diagnosis.channel import Array

MAX_BYTES = 500_000_000
"""Largest text that is read."""
SEPARATORS = ";\t,"
"""Tried in this order: where semicolons or tabs part the cells, a comma is a decimal mark."""
COMMENTS = ("#", "%")
"""What lines of a preamble begin with; the last of them may be the header."""
MOST_TITLES = 50
"""Lines of text above a table at most."""
ENCODINGS = ("utf-8-sig", "cp1252")
"""Of text, tried in this order: loggers of today, and spreadsheets of Windows in western Europe."""
BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""What a text begins with that a spreadsheet saved as "Unicode": two bytes a letter."""
FILLED = 0.5
"""Share of the numbers of a usual row from which a row belongs to the table and no longer to its titles."""
LONGEST_UNIT = 10
"""Letters of a unit at most."""
FEW = 0.02
"""Share of the cells of a column that may be text, such as `ERR` or a line that ends the file."""
FIRST = 50
"""Rows that tell whether a comma is a decimal mark."""
DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
ISO_TIME = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[+-]\d\d:?\d\d)?")


def read_table(path: Path) -> dict[str, Array]:
    """Return the numeric columns of a text file; without a header columns are c0, c1, ...

    ISO times become seconds since 1970, UTC where no zone is given. Columns of text are left out; empty cells are nan.
    """
    lines = [line for line in decoded(path).splitlines() if line.strip()]
    preamble = 0
    while preamble < len(lines) and lines[preamble].lstrip().startswith(COMMENTS):
        preamble += 1
    body = lines[preamble:]
    if not body:
        raise ValueError("no rows")
    mark = separator(body[len(body) // 2])
    rows = list(csv.reader(body, delimiter=mark)) if mark else [line.split() for line in body]
    comma = mark in (";", "\t", None) and any(DECIMAL_COMMA.fullmatch(c.strip()) for r in rows[:FIRST] for c in r)
    rows = rows[_titles(rows, comma) :]
    first = [value_of(cell, comma) for cell in rows[0]]
    if all(value is not None for value in first):
        header = _names(lines[preamble - 1], mark, len(rows[0])) if preamble else None
        header = header or [f"c{i}" for i in range(len(rows[0]))]
    else:
        header, rows = [cell.strip() for cell in rows[0]], rows[1:]
    if len(set(header)) < len(header):
        twice = next(name for name in header if header.count(name) > 1)
        raise ValueError(f"column {twice!r} is there twice")
    if rows and _are_units(rows[0]):
        header, rows = _with_units(header, rows[0]), rows[1:]
    found = {name: _column([r[i] if i < len(r) else "" for r in rows], comma) for i, name in enumerate(header)}
    return {name: x for name, x in found.items() if x is not None}


def decoded(path: Path) -> str:
    """Return the text of a file in whichever of the usual encodings it is.

    Raises:
        FileError: it cannot be read, or is no text.
    """
    data = read_bytes(path, MAX_BYTES)
    wide = data.startswith(BYTE_ORDER_MARKS)
    if b"\0" not in data or wide:
        for encoding in ("utf-16",) if wide else ENCODINGS:
            try:
                return data.decode(encoding)
            except UnicodeDecodeError:
                continue
    raise FileError("is no text", path=path, limit="UTF-8, UTF-16, Windows-1252", remedy="save the table as UTF-8")


def _titles(rows: list[list[str]], comma: bool) -> int:
    """Return how many rows of text stand above the header, which is the fullest row above the numbers.

    A spreadsheet fills the lines above its table up with empty cells, so that they are as wide as the table.
    """
    usual = sum(map(_filled, rows[len(rows) // 2]))
    least = FILLED * sum(_filled(c) and value_of(c, comma) is not None for c in rows[len(rows) // 2])
    numbers = (sum(_filled(c) and value_of(c, comma) is not None for c in row) >= max(least, 1.0) for row in rows)
    above = [sum(map(_filled, row)) for row in rows[: next((i for i, told in enumerate(numbers) if told), 0)]]
    if not above or len(above) > MOST_TITLES:
        return 0
    header = above.index(max(above))
    return header if 2 * above[header] > usual else len(above)


def _filled(cell: str) -> bool:
    return bool(cell.strip())


def separator(line: str) -> str | None:
    """Return what parts the cells of a line; None: blanks."""
    outside = re.sub(r'"[^"]*"', "", line)
    return next((m for m in SEPARATORS if m in outside), None)


def _names(line: str, mark: str | None, width: int) -> list[str] | None:
    """Names in the last line of a preamble; None where it is no header."""
    bare = line.lstrip().lstrip("".join(COMMENTS)).strip()
    names = [x.strip() for x in (bare.split(mark) if mark else bare.split())]
    return names if len(names) == width else None


def value_of(cell: str, comma: bool) -> float | list[object] | None:
    """Return a cell as a number, seconds of an ISO time, or a list; None for text, nan for nothing."""
    text = cell.strip()
    if not text:
        return float("nan")
    if text.startswith("["):
        found = parse_json(text.replace("nan", "NaN"))
        return found if isinstance(found, list) else None
    try:
        return float(text.replace(",", ".") if comma else text)
    except ValueError:
        return seconds(text)


def seconds(text: str) -> float | None:
    """Return an ISO time as seconds since 1970; None for any other text."""
    if not ISO_TIME.fullmatch(text):
        return None
    text = text.replace(",", ".").replace("Z", "+00:00")
    if match := re.search(r"\.(\d+)", text):  # before 3.11 Python takes three or six digits only
        text = text.replace(match[0], "." + match[1][:6].ljust(6, "0"))
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=timezone.utc)).timestamp()


def _are_units(row: list[str]) -> bool:
    """Return whether a row below the header holds units: words where numbers should be, none of them long."""
    cells = [cell.strip() for cell in row]
    return (
        any(cells) and all(value_of(c, True) is None or not c for c in cells) and max(map(len, cells)) <= LONGEST_UNIT
    )


def _with_units(header: list[str], units: list[str]) -> list[str]:
    """Return the names of the columns with the units of the row below, as headers have them."""
    cells = [*(u.strip().strip("[]()") for u in units), *[""] * len(header)]
    return [f"{name} [{unit}]" if unit else name for name, unit in zip(header, cells, strict=False)]


def _column(cells: list[str], comma: bool) -> Array | None:
    """Cells as (n,) or, where they hold lists, (n, k); None where more than a few are text, which become nan."""
    values = [value_of(cell, comma) for cell in cells]
    text = sum(value is None for value in values)
    if text > FEW * len(values):
        return None
    values = [float("nan") if value is None else value for value in values] if text else values
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError):
        return None
