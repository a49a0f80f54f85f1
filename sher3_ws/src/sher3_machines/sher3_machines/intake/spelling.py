"""How headers are spelled: tables and columns."""

from __future__ import annotations

import re

PARTING = re.compile(r"/(?![^\[(]*[\])])")
"""The stroke between a table and its column."""


def table_of(name: str) -> str:
    """Return the table a column lies in, empty for none; a stroke in the unit (`v [rad/s]`) parts nothing."""
    return name[: max(len(name) - len(bare(name)) - 1, 0)]


def bare(name: str) -> str:
    """Return a column's name without its table."""
    return PARTING.split(name)[-1]
