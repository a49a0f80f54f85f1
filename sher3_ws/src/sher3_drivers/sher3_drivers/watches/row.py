"""What is kept of one axis in a table that compiled code goes through in every tick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sher3_drivers.units import AxisScale


class Row:
    """The row of one axis, in m or rad.

    Args:
        scale: of the axis.
        rows: of all axes.
        number: of its row.
        limits: field -> value that does not change.
    """

    __slots__ = ("_name", "_number", "_rows", "_unit")

    def __init__(self, scale: AxisScale, rows: Any, number: int, limits: Mapping[str, float]) -> None:
        self._name, self._unit, self._rows, self._number = scale.name, scale.unit, rows, number
        for name, value in limits.items():
            rows[name][number] = value

    def __getitem__(self, name: str) -> float:
        """Return a field of the row."""
        return self._rows[name][self._number].item()
