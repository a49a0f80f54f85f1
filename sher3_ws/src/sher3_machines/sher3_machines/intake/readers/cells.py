"""What a cell of a table says: a number, a time, a list of numbers, nothing, or a text."""

from __future__ import annotations

import re
from datetime import datetime, timezone

from sher3_common import parse_json

DATE_TIME = re.compile(r"\d{4}[-/]\d\d[-/]\d\d[T ]\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[+-]\d\d:?\d\d)?")
"""ISO times, and those of archives that part the date by strokes."""
OF_DAY = re.compile(r"([01]?\d|2[0-3]):([0-5]\d):([0-5]\d([.,]\d+)?)")
"""A time of a day, with its seconds."""
LIST = re.compile(r"[\[({](?P<inside>[^\[\](){}]*)[\])}]")
"""A list in a cell: `[1, 2]`, `(1; 2)`, and `[1. 2.]` as NumPy prints it."""


def value_of(cell: str, comma: bool) -> float | list[object] | None:
    """Return a cell as a number, seconds of a time, or a list; None for text, nan for nothing.

    Args:
        cell: its text.
        comma: whether a comma is the decimal mark.
    """
    text = cell.strip()
    if not text:
        return float("nan")
    if text[0] in "[({":
        return _list(text, comma)
    try:
        return float(text.replace(",", ".") if comma else text)
    except ValueError:
        return seconds(text)


def _list(text: str, comma: bool) -> list[object] | None:
    """Return a list of numbers in a cell, nested ones as JSON has them; None for any other text."""
    match = LIST.fullmatch(text)
    if match is None:
        found = parse_json(text.replace("nan", "NaN")) if text.startswith("[[") else None
        return found if isinstance(found, list) else None
    parts = re.split(r"[;\s]+" if comma else r"[,;\s]+", match["inside"].strip().strip(",;"))
    try:
        return [float(part.replace(",", ".")) for part in parts] if parts != [""] else []
    except ValueError:
        return None


def seconds(text: str) -> float | None:
    """Return a time as seconds since 1970, UTC where no zone is given, or of its day; None for any other text."""
    if of_day := OF_DAY.fullmatch(text):
        return 3600.0 * int(of_day[1]) + 60.0 * int(of_day[2]) + float(of_day[3].replace(",", "."))
    if not DATE_TIME.fullmatch(text):
        return None
    text = text.replace(",", ".").replace("Z", "+00:00").replace("/", "-")
    if match := re.search(r"\.(\d+)", text):  # before 3.11 Python takes three or six digits only
        text = text.replace(match[0], "." + match[1][:6].ljust(6, "0"))
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=timezone.utc)).timestamp()
