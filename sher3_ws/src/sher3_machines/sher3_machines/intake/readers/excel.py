"""Workbooks of spreadsheets, where `openpyxl` is installed."""

from __future__ import annotations

from datetime import datetime, time, timezone
from importlib import import_module
from pathlib import Path
from typing import Any

from sher3_diagnosis.channel import Array

from sher3_machines.errors import no_reader
from sher3_machines.intake.readers.rows import columns_of


def read_workbook(path: Path) -> dict[str, Array]:
    """Return the numeric columns (rows,) of a workbook; of several sheets with numbers as `sheet/column`.

    Raises:
        MachineError: no reader is installed.
        ValueError: no sheet holds a table.
    """
    try:
        openpyxl = import_module("openpyxl")
    except ImportError as error:
        raise no_reader(path, "workbooks", "openpyxl", "install sher3[excel], or save the sheet as csv") from error
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    except Exception as error:  # whatever the reader makes of a bad file
        raise ValueError(f"{type(error).__name__}: {error}") from error
    sheets = {sheet.title: _table(sheet) for sheet in book.worksheets}
    sheets = {title: table for title, table in sheets.items() if table}
    if not sheets:
        raise ValueError("no sheet holds a table of numbers")
    if len(sheets) == 1:
        return next(iter(sheets.values()))
    return {f"{title}/{name}": x for title, table in sheets.items() for name, x in table.items()}


def _table(sheet: Any) -> dict[str, Array]:
    rows = [[_text(cell) for cell in row] for row in sheet.iter_rows(values_only=True)]
    rows = [row for row in rows if any(row)]
    width = max((i + 1 for row in rows for i, cell in enumerate(row) if cell), default=0)
    return columns_of([row[:width] for row in rows], comma=False) if rows else {}


def _text(cell: Any) -> str:
    """Return a cell as text that a table of text would have: times as ISO has them, of a day as its seconds."""
    if cell is None:
        return ""
    if isinstance(cell, datetime):
        return cell.replace(tzinfo=cell.tzinfo or timezone.utc).isoformat(" ")
    if isinstance(cell, time):
        return repr(3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond)
    return str(cell)
