"""The contribution ranking: what each cause adds to the figures of the standard."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array

from sher3_static.positioning.iso import Circular, Positioning
from sher3_static.table import Table


class Figures(Protocol):
    """What a standard says of a test.

    Attributes:
        standard: its number.
        unit: of the figures.
    """

    standard: str

    unit: str
    """Unit of the figures."""

    def without(self, part: Array) -> Positioning | Circular:
        """Return the figures after a part (g,) of the deviations is taken off."""


def ranking(table: Table, attribution: Attribution) -> list[str]:
    """Return the figures as measured, what they would be without each cause, largest gain first, and without all."""
    figures: Figures = table.known
    found = contributions(table, attribution)
    nothing = np.zeros(table.view.rows)
    measured = figures.without(nothing)
    lines = [f"{table.name}: {figures.standard}, {figures.unit}: {measured}"]
    without = sorted(((figures.without(part), effect, site) for effect, site, part in found), key=lambda x: x[0][0])
    for rank, (left, effect, site) in enumerate(without, start=1):
        share = (measured[0] - left[0]) / measured[0]
        lines.append(f"{table.name}: contribution {rank}: {effect} on {site}: {share:.0%}; without it {left}")
    if len(found) > 1:
        whole = sum((part for _, _, part in found), nothing)
        lines.append(f"{table.name}: without all of them {figures.without(whole)}")
    return lines


def contributions(table: Table, attribution: Attribution) -> list[tuple[str, str, Array]]:
    """Return each cause with its site and what it adds to every row, (g,), m or rad."""
    out = []
    for term, found in attribution.named:
        columns = term.effect.signature(table.view, term.site, term.shape).columns[table.channel]
        out.append((term.effect.id, term.site, columns[:, 0] @ found))
    return out
