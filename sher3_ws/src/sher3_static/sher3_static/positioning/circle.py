"""A circle of two axes as a table: quadrants take the place of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.localise.floors import noise_of_bends
from sher3_effects import pages
from sher3_effects.table_view import CircleView

from sher3_static.positioning.axis import RESOLVED
from sher3_static.positioning.description import CircleTest
from sher3_static.positioning.iso import Circular, circular
from sher3_static.readings import Readings, joined
from sher3_static.table import PARTS, Table

POLE = 1.5
"""Points on either side of a pole at which nobody knows whether the axis had turned round when the point was taken."""


@dataclass(frozen=True)
class CircleFigures:
    """What the standard says of one circle.

    Attributes:
        radius: (g,) as measured, m.
        view: its points.
    """

    radius: Array
    view: CircleView
    unit, standard = "um", "ISO 230-4"

    def without(self, part: Array) -> Circular:
        """Return the figures after a part (g,) of the radius is taken off.

        A step at a pole that is taken off a point too early or too late would be the largest deviation by itself, so
        that these points are left out then.
        """
        angle = self.view.angle
        kept = away_from_poles(angle) if part.any() else np.ones(len(part), dtype=bool)
        return circular(angle[kept], (self.radius - part)[kept], self.view.turning[kept])


def circle_table(test: CircleTest, runs: Sequence[Readings]) -> Table:
    """Return the table of one plane: the radius of each run about its own centre, which is free, as its length is."""
    rows = joined([centred(run) for run in runs])
    angle, turning = rows["angle"], rows["turning"]
    view = CircleView(np.zeros(len(angle)), angle, turning, test.radius)
    quadrant = (np.floor((angle + np.pi) / (2.0 * np.pi) * 3.0 * PARTS) % PARTS).astype(int)
    set_up = np.stack([np.ones(view.rows), np.cos(angle), np.sin(angle)], axis=-1)[:, None, :]
    return Table(
        name=test.name,
        channel=Channel("mechanism", test.name),
        view=view,
        residual=(rows["radius"] - test.radius)[:, None],
        floor=np.array([test.noise or innovation(rows["radius"])]),
        spread=np.array([test.radius]),
        part=quadrant + PARTS * (turning > 0.0),
        run=rows["run"],
        unit="m",
        pages=pages("circle"),
        places={"plane": (test.name,), "axis": (f"{test.name}.x", f"{test.name}.y")},
        free=set_up,
        zeros=set_up,
        known=CircleFigures(rows["radius"], view),
    )


def centred(run: Readings) -> Readings:
    """Return the points of one run about their mean centre: `angle`, `radius`, and in which sense they `turn`."""
    x, y = run["x"], run["y"]
    design = np.column_stack([2.0 * x, 2.0 * y, np.ones(len(x))])
    cx, cy, _ = np.linalg.lstsq(design, x**2 + y**2, rcond=None)[0]
    angle = np.arctan2(y - cy, x - cx)
    step = np.sign(np.gradient(np.unwrap(angle)))
    turning = np.where(step == 0.0, 1.0, step)
    return Readings(run.name, {"angle": angle, "radius": np.hypot(x - cx, y - cy), "turning": turning})


def away_from_poles(angle: Array) -> Mask:
    """Return (g,) False at the points of a circle next to a pole, where one of its axes turns round."""
    step = float(np.median(np.abs(np.angle(np.exp(1j * np.diff(angle))))))
    quarter = 0.5 * np.pi
    return np.asarray(np.abs(angle - quarter * np.round(angle / quarter)) > POLE * step)


def innovation(radius: Array) -> float:
    """Return the standard deviation of a radius (n,), m, from second differences, which smooth errors hardly have."""
    second = np.diff(radius, 2)
    return max(RESOLVED, float(noise_of_bends(second - np.median(second))))
