"""Matrices that are tables: of time and place, or of place, speed and force, under one name.

The entries of such a matrix are no joints. They show by repeating columns of which each has a name of its own.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.tables import Tables

SAME = 1e-5
"""Share of its travel by which a column differs from one that it repeats: both were printed with five digits."""


def without_strangers(
    found: Mapping[tuple[str, int | None], tuple[str, str]], tables: Tables, clock: str | None
) -> dict[tuple[str, int | None], tuple[str, str]]:
    """Return the signals without entries of a matrix that stand in another column: its clock, or another signal.

    A matrix of one name may be a table, of which every other column has a name that says more. A place that repeats
    what was asked of it stays, and one that repeats a column of places from another zero goes.
    """
    known: list[tuple[str, bool, Array]] = [("time", True, tables[clock])] if clock else []
    out: dict[tuple[str, int | None], tuple[str, str]] = {}
    for (name, index), (signal, axis) in sorted(found.items(), key=lambda item: item[0][1] is not None):
        x = tables[name] if index is None else tables[name][:, index]
        others = (y for kind, alone, y in known if kind != _kind(signal) or (alone and signal == "position"))
        if index is None or not np.ptp(x) > 0.0 or not any(_again(x, y) for y in others):
            out[name, index] = signal, axis
        known.append((_kind(signal), index is None, x))
    return {place: out[place] for place in found if place in out}


def _kind(signal: str) -> str:
    """Return a signal, with all that are places as one: a place may well repeat what was asked of it."""
    return "position" if signal in ("position", "load", "reference") else signal


def _again(x: Array, y: Array) -> bool:
    """Return whether two columns (n,) are one reading, from whatever zeros."""
    return x.shape == y.shape and bool(np.ptp(x - y) < SAME * np.ptp(x))
