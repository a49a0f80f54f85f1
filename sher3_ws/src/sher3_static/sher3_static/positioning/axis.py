"""A positioning test of one axis as a table: cycles take the place of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_effects import pages
from sher3_effects.table_view import TableView
from sher3_machines.errors import MachineError

from sher3_static.positioning.description import AxisTest
from sher3_static.positioning.iso import Positioning, positioning
from sher3_static.readings import Labels, Readings, joined, one_hot, same, scatter_beyond
from sher3_static.table import PARTS, Table

RESOLVED = 1e-9
"""Smallest floor, m or rad: rows that agree to the last digit are limited by their rounding, not by the machine."""
UNITS = {"linear": ("m", "um"), "rotary": ("rad", "urad")}
"""Motion -> unit of a deviation, and the millionth of it that the standard's figures are given in."""


@dataclass(frozen=True)
class AxisFigures:
    """What the standard says of one axis.

    Attributes:
        rows: `target`, `deviation` and `direction`, (g,) each.
        unit: of the figures.
    """

    rows: dict[str, Array]
    unit: str
    standard = "ISO 230-2"

    def without(self, part: Array) -> Positioning:
        """Return the figures after a part (g,) of the deviations is taken off."""
        return positioning(self.rows["target"], self.rows["deviation"] - part, self.rows["direction"])


def axis_table(test: AxisTest, runs: Sequence[Readings]) -> Table:
    """Return the table of one axis; cycles of all files follow each other.

    Raises:
        MachineError: one cycle and no stated noise, so that nobody knows what repeats.
    """
    rows = joined(counted_on(runs))
    target = rows["target"] - 0.5 * (rows["target"].max() + rows["target"].min())
    warm = rows["temperature"] - test.reference_temperature if "temperature" in rows else np.zeros(len(target))
    view = TableView(warm, target, rows["direction"], test.lead)
    unit, millionth = UNITS[test.motion]
    return Table(
        name=test.name,
        channel=Channel("transmission", test.name),
        view=view,
        residual=rows["deviation"][:, None],
        floor=np.array([test.noise or scatter(test.name, rows, target)]),
        spread=np.std(target, keepdims=True),
        part=parts_of(rows["cycle"]),
        run=rows["run"],
        unit=unit,
        pages=pages("table", {"lead"} if test.lead else set()),
        places={"axis": (test.name,)},
        rotary=frozenset({test.name} if test.motion == "rotary" else ()),
        free=np.ones((view.rows, 1, 1)),
        zeros=np.ones((view.rows, 1, 1)),
        known=AxisFigures(rows, millionth),
    )


def counted_on(runs: Sequence[Readings]) -> list[Readings]:
    """Return the rows of several files with their cycles counted on."""
    counts = np.cumsum([0.0, *(run["cycle"].max() + 1.0 for run in runs)])
    return [
        Readings(run.name, {**run.columns, "cycle": run["cycle"] + first})
        for run, first in zip(runs, counts, strict=False)
    ]


def parts_of(cycle: Array) -> Labels:
    """Return labels (n,) of rows that are held out together: the cycle (n,); of one or two cycles every fourth row."""
    return cycle if len(np.unique(cycle)) > 2 else np.arange(len(cycle)) % PARTS


def scatter(name: str, rows: dict[str, Array], target: Array) -> float:
    """Return the standard deviation [m or rad] of rows (n,) by which cycles differ beyond offset and scale of each.

    Raises:
        MachineError: there are too few repeats.
    """
    own = one_hot(rows["cycle"])[:, 1:]
    x = np.hstack([same(rows["target"], rows["direction"]), own, own * target[:, None]])
    found, free = scatter_beyond(x, rows["deviation"][:, None])
    if free < 1:
        remedy = "measure each target twice from the same side, or state `noise`"
        what = f"{name}: no target was met twice from one side"
        raise MachineError(what, value=free, limit="1 repeat", remedy=remedy)
    return max(RESOLVED, float(found[0]))
