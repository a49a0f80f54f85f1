"""How headers are spelled: tables and columns."""

from __future__ import annotations

import re

PARTING = re.compile(r"(?!(?<=[ _]rad)/s$|(?<=[ _]deg)/s$|(?<=[ _]mm)/s$|(?<=[ _]m)/s$)/(?![^\[(]*[\])])")
"""The stroke between a table and its column; one in a unit parts nothing: `v [rad/s]`, `wheel_rad/s`."""


def table_of(name: str) -> str:
    """Return the table a column lies in, empty for none; a stroke in the unit parts nothing."""
    return name[: max(len(name) - len(bare(name)) - 1, 0)]


def bare(name: str) -> str:
    """Return a column's name without its table."""
    return PARTING.split(name)[-1]
