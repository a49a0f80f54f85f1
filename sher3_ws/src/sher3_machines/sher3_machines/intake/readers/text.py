"""Tables as text: commas, semicolons, tabs or blanks; decimal points or commas; ISO times; units in the header."""

from __future__ import annotations

import csv
import re
from collections import Counter
from itertools import groupby
from pathlib import Path

from sher3_common import FileError, read_bytes
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.cells import value_of
from sher3_machines.intake.readers.long import is_long, tables_of_readings
from sher3_machines.intake.readers.rows import columns_of, names_of, usual_row
from sher3_machines.intake.readers.shapes import SAMPLES

MAX_BYTES = 500_000_000
"""Largest text that is read."""
SEPARATORS = ";\t,"
"""Tried in this order: where semicolons or tabs part the cells, a comma is a decimal mark."""
COMMENTS = ("#", "%")
"""What lines of a preamble begin with; the last of them may be the header."""
ENCODINGS = ("utf-8-sig", "cp1252")
"""Of text, tried in this order: loggers of today, and spreadsheets of Windows in western Europe."""
BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""What a text begins with that a spreadsheet saved as "Unicode": two bytes a letter."""
FIRST = 50
"""Rows that tell how the cells of a table are written: whether a comma is a decimal mark, whether cells are quoted."""
DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
STAMPED = re.compile(r"(?m)^(\d{4}-\d\d-\d\d) (\d\d:\d\d:\d\d),(\d{3})[ \t]+")
"""What each line of a log of Python begins with: date, time of day, and milliseconds behind a comma."""
PADDED = re.compile(r"\t *,|, *\t")
"""A comma with a tab beside it."""
QUOTED = re.compile(r'"[^"]*"')
LISTED = re.compile(r"(?:^|(?<=[,;\t]))\s*\[[^\[\]]*\]")
"""A list in a cell without quotes, whose commas part no cells."""
BLANKS = re.compile(r"\[[^\[\]]*\]|\S+")
"""Cells that blanks part; a list is one cell."""
WIDE_BLANKS = re.compile(r"\s{2,}")
"""What parts titles of several words, `Encoder 1 Pos`, over columns that blanks part."""


def read_table(path: Path) -> dict[str, Array]:
    """Return the numeric columns (rows,) of a text file; without a header columns are c0, c1, ...

    ISO times become seconds since 1970, UTC where no zone is given. Columns of text are left out; empty cells are nan.
    A log with a channel, a stamp and a reading in each line becomes `CHANNEL/stamp` and `CHANNEL/value`.

    Raises:
        FileError: the file cannot be read, or is no text.
        ValueError: it has no rows.
    """
    lines = _unbracketed([line for line in _without_padding(decoded(path)).splitlines() if line.strip()])
    preamble = 0
    while preamble < len(lines) and lines[preamble].lstrip().startswith(COMMENTS):
        preamble += 1
    body = _largest(lines[preamble:])
    if not body:
        raise ValueError("no rows")
    mark = separator(body[usual_row(len(body))])
    body = _ended(_without_remarks(body, mark), mark)
    rows = list(csv.reader(map(_quoted, body), delimiter=mark)) if mark else _parted_by_blanks(body)
    comma = mark in (";", "\t", None) and any(DECIMAL_COMMA.fullmatch(c.strip()) for r in rows[:FIRST] for c in r)
    if is_long(rows):
        return tables_of_readings(rows)
    width = len(rows[usual_row(len(rows))])
    return columns_of(rows, comma, names_of([_names(line, mark, width) for line in lines[:preamble]]))


def _without_padding(text: str) -> str:
    """Return a text without the tabs that stand beside commas to line its columns up, its stamps in one cell."""
    if STAMPED.match(text):
        behind = STAMPED.sub("", text.partition("\n")[0])
        text = STAMPED.sub(r"\1T\2.\3" + ("," if "," in behind else " "), text)
    return PADDED.sub(",", text) if "\t" in text and 2 * len(PADDED.findall(text)) > text.count(",") else text


def _largest(lines: list[str]) -> list[str]:
    """Return the lines of the table that holds most cells, with what stands above it, without remarks between its rows.

    Another table is a stretch of lines of another width that begins with numbers: one with titles of its own is left.
    """
    middle = lines[len(lines) // 2 :][:FIRST]
    mark = _shape(middle[0])[0] if middle else None
    if mark and len({line.count(mark) for line in lines}) == 1:  # one table, as most files are
        return lines
    if any(sign in line for line in middle for sign in '"[' if line.strip('"')):  # cells with marks of their own
        return lines
    stretches = [(shape, list(group)) for shape, group in groupby(lines, _shape)]
    cells = Counter[tuple[str | None, int]]()
    for shape, group in stretches:
        cells[shape] += shape[1] * len(group)
    common = max(cells, key=lambda shape: cells[shape], default=(None, 0))
    first = next((i for i, (shape, _) in enumerate(stretches) if shape == common), 0)
    out = [line for _, group in stretches[:first] for line in group]
    for shape, group in stretches[first:]:
        remark = common[0] is not None and shape[0] != common[0]
        other = shape != common and len(group) >= SAMPLES and _numbers(group[0])
        out += [] if remark or other else group
    return out


def _shape(line: str) -> tuple[str | None, int]:
    """Return what parts the cells of a line and how many they are."""
    mark = next((m for m in SEPARATORS if m in line), None)
    return mark, line.count(mark) + 1 if mark else len(line.split())


def _numbers(line: str) -> bool:
    """Return whether all cells of a line are numbers."""
    mark = separator(line)
    return all(value_of(cell, True) is not None for cell in (line.split(mark) if mark else line.split()))


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


def separator(line: str) -> str | None:
    """Return what parts the cells of a line; None: blanks."""
    outside = LISTED.sub("", QUOTED.sub("", line))
    return next((m for text in (outside.strip(SEPARATORS), outside) for m in SEPARATORS if m in text), None)


def _unbracketed(lines: list[str]) -> list[str]:
    """Return the lines of a matrix as MATLAB writes it, `[1 2; 3 4]`, a row a line, without its signs and what follows.

    A script goes on behind its matrix; a list in a cell ends in the line in which it begins.
    """
    opened = next((i for i, line in enumerate(lines) if "[" in line), len(lines))
    closed = next((i for i, line in enumerate(lines[opened:], opened) if "]" in line), opened)
    if closed == opened and not (opened == len(lines) - 1 and lines[opened].rstrip("; ").endswith("]")):
        return lines
    inside = [lines[opened].partition("[")[2], *lines[opened + 1 : closed], lines[closed].partition("]")[0]]
    inside = inside[:1] if closed == opened else inside
    rows = [row.strip("] \t") for line in inside for row in line.split(";")]
    return [*lines[:opened], *(row for row in rows if row)]


def _parted_by_blanks(lines: list[str]) -> list[list[str]]:
    """Return the cells of lines that blanks part; wide blanks, where titles of several words stand above columns."""
    rows = [BLANKS.findall(line) for line in lines]
    return [_titles(lines[0], len(rows[usual_row(len(rows))])), *rows[1:]]


def _titles(line: str, width: int) -> list[str]:
    """Return the cells of a line that blanks part: as many as a table is wide, where wide blanks part so many."""
    cells, wide = BLANKS.findall(line), WIDE_BLANKS.split(line.strip())
    return wide if len(cells) > width == len(wide) else cells


def _ended(lines: list[str], mark: str | None) -> list[str]:
    """Return lines without a sign behind their last cell that parts no cells: `1.0,2.0;`."""
    signs = SEPARATORS.replace(mark or "\t", "")
    table = lines[len(lines) // 2 :]
    return [line.rstrip(signs) for line in lines] if all(line.rstrip()[-1:] in signs for line in table) else lines


def _without_remarks(lines: list[str], mark: str | None) -> list[str]:
    """Return the lines of a table that a spreadsheet took for one column of text, without the columns beside it.

    Such a table has semicolons or tabs in its first cell and commas behind them, as many in each line, its titles
    included; between them stand remarks. Where tabs stand behind commas too, the commas are decimal ones.
    """
    if mark not in (";", "\t") or not all("," in line for line in (lines[0], lines[-1])):
        return lines
    rows = list(csv.reader(lines))
    beside = any(mark in cell for row in rows for cell in row[1:])
    return lines if beside or len({len(row) for row in rows}) > 1 else [row[0] for row in rows]


def _quoted(line: str) -> str:
    """Return a line with quotes about the lists that have none."""
    return line if "[" not in line or '"' in line else LISTED.sub(lambda match: f'"{match[0].strip()}"', line)


def _names(line: str, mark: str | None, width: int) -> list[str]:
    """Names in a line of a preamble, over a table of so many columns."""
    bare = line.lstrip().lstrip("".join(COMMENTS)).strip()
    return [x.strip() for x in bare.split(mark)] if mark else _titles(bare, width)
