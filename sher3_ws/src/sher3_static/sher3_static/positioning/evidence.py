"""Residuals and floors of positioning tests: cycles take the place of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.effect import Effect, Shape, Signature, column
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import make_term
from sher3_diagnosis.fit.whitened import Whitened
from sher3_diagnosis.judge.causes import NUISANCE
from sher3_machines.errors import MachineError

from sher3_static.positioning.description import AxisTest, CircleTest
from sher3_static.positioning.record import Tests
from sher3_static.positioning.view import RingView, RowsView

RESOLVED = 1e-9
"""Smallest floor, m or rad: rows that agree to the last digit are limited by their rounding, not by the machine."""
SECTORS = 4
"""Parts of each turn that take the place of runs: quadrants, so that what is held out is never a whole circle."""


@dataclass(frozen=True, kw_only=True)
class TableEvidence(Evidence):
    """The engine's evidence for one test.

    Attributes:
        test: as described.
        rows: targets, deviations, directions and cycles of an axis; x and y of a plane.
    """

    test: AxisTest | CircleTest
    rows: dict[str, Array]

    @property
    def channel(self) -> Channel:
        """The one channel of the test."""
        return Channel("transmission" if isinstance(self.test, AxisTest) else "mechanism", self.test.name)


class Zero(Effect):
    """The zero of a reading: a column that every fit carries."""

    id, family, stage = "zero_of_the_reading", NUISANCE, "transmission"
    explanation = "Nobody says where the reference has its zero."

    def signature(self, view: RowsView, site: str, shape: Shape) -> Signature:
        """Return one column: one."""
        return Signature({Channel(self.stage, site): column(np.ones(view.rows))})


class Centre(Effect):
    """Centre and mean radius of a circle: columns that every fit carries."""

    id, family, stage = "centre_of_the_circle", NUISANCE, "mechanism"
    explanation = "Nobody says where the instrument was set up, nor how long it is."

    def signature(self, view: RingView, site: str, shape: Shape) -> Signature:
        """Return three columns: radius, and the centre's shift along x and y."""
        parts = (np.ones(view.rows), np.cos(view.angle), np.sin(view.angle))
        return Signature({Channel(self.stage, site): column(*parts)})


def gather_axis_test(test: AxisTest, runs: Sequence[Tests]) -> TableEvidence:
    """Return the evidence of one axis; cycles of all files follow each other.

    Raises:
        MachineError: one cycle and no stated noise, so that nobody knows what repeats.
    """
    rows = joined([run.axes[test.name] for run in runs])
    target = rows["target"] - 0.5 * (rows["target"].max() + rows["target"].min())
    warm = rows["temperature"] - test.reference_temperature if "temperature" in rows else np.zeros(len(target))
    view = RowsView(len(target), target, rows["direction"], warm, test.lead)
    channel = Channel("transmission", test.name)
    blocks = blocks_of(rows["cycle"])
    floor = np.array([test.noise or scatter(test.name, rows, target)])
    residuals = [{channel: Residual(rows["deviation"][:, None], ok)} for ok in blocks]
    data = Whitened([view] * len(blocks), residuals, [{channel: floor}] * len(blocks))
    return TableEvidence(
        excitations=["cycle"] * len(blocks),
        data=data,
        units={channel: "m" if test.motion == "linear" else "rad"},
        places={"axis": (test.name,)},
        rotary=frozenset({test.name} if test.motion == "rotary" else ()),
        nuisance=(make_term(data, Zero(), test.name, {}),),
        test=test,
        rows=rows,
    )


def joined(parts: Sequence[dict[str, Array] | object]) -> dict[str, Array]:
    """Return the rows of several files after each other, their cycles counted on."""
    out: dict[str, list[Array]] = {}
    first = 0.0
    for part in parts:
        assert isinstance(part, dict)
        for name, x in part.items():
            out.setdefault(name, []).append(x + first if name == "cycle" else x)
        first += float(part["cycle"].max()) + 1.0 if "cycle" in part else 0.0
    return {name: np.concatenate(x) for name, x in out.items()}


def blocks_of(cycle: Array) -> list[np.ndarray]:
    """Return which rows are held out together: each cycle; of one or two cycles every fourth row."""
    if len(np.unique(cycle)) > 2:
        return [cycle == k for k in np.unique(cycle)]
    order = np.arange(len(cycle)) % SECTORS
    return [order == k for k in range(SECTORS)]


def scatter(name: str, rows: dict[str, Array], target: Array) -> float:
    """Return the standard deviation of a reading from what cycles differ by beyond an offset and a scale of each.

    Raises:
        MachineError: there are too few repeats.
    """
    keys = np.column_stack([rows["target"], rows["direction"]])
    cell = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
    cycle = rows["cycle"].astype(int)
    cells = np.eye(cell.max() + 1)[cell]
    own = np.eye(cycle.max() + 1)[cycle][:, 1:]
    x = np.hstack([cells, own, own * target[:, None]])
    free = len(target) - np.linalg.matrix_rank(x)
    if free < 1:
        remedy = "measure each target twice from the same side, or state `noise`"
        raise MachineError(
            f"{name}: no target was met twice from one side", value=free, limit="1 repeat", remedy=remedy
        )
    left = rows["deviation"] - x @ np.linalg.lstsq(x, rows["deviation"], rcond=None)[0]
    return max(RESOLVED, float(np.sqrt(np.sum(left**2) / free)))


def gather_circle(test: CircleTest, runs: Sequence[Tests]) -> TableEvidence:
    """Return the evidence of one plane: the radius about the mean centre."""
    rows = joined([run.planes[test.name] for run in runs])
    turning = np.concatenate([turns(run.planes[test.name]) for run in runs])
    design = np.column_stack([2.0 * rows["x"], 2.0 * rows["y"], np.ones(len(turning))])
    cx, cy, _ = np.linalg.lstsq(design, rows["x"] ** 2 + rows["y"] ** 2, rcond=None)[0]
    angle, radius = np.arctan2(rows["y"] - cy, rows["x"] - cx), np.hypot(rows["x"] - cx, rows["y"] - cy)
    view = RingView(len(angle), angle, turning, test.radius)
    channel = Channel("mechanism", test.name)
    floor = np.array([test.noise or innovation(radius)])
    sector = (np.floor((angle + np.pi) / (2.0 * np.pi) * 3.0 * SECTORS) % SECTORS).astype(int) + SECTORS * (
        turning > 0.0
    )
    blocks = [sector == k for k in np.unique(sector)]
    residuals = [{channel: Residual((radius - test.radius)[:, None], ok)} for ok in blocks]
    data = Whitened([view] * len(blocks), residuals, [{channel: floor}] * len(blocks))
    return TableEvidence(
        excitations=["circle"] * len(blocks),
        data=data,
        units={channel: "m"},
        places={"plane": (test.name,), "axis": (f"{test.name}.x", f"{test.name}.y")},
        nuisance=(make_term(data, Centre(), test.name, {}),),
        test=test,
        rows={"angle": angle, "radius": radius, "turning": turning},
    )


def turns(rows: dict[str, Array] | object) -> Array:
    """Return +1 or -1 (n,): the sense in which the points of one file follow each other."""
    assert isinstance(rows, dict)
    x, y = rows["x"] - rows["x"].mean(), rows["y"] - rows["y"].mean()
    step = np.sign(np.gradient(np.unwrap(np.arctan2(y, x))))
    return np.where(step == 0.0, 1.0, step)


def innovation(radius: Array) -> float:
    """Return the standard deviation of a radius from its second differences, which smooth errors hardly have."""
    second = np.diff(radius, 2)
    return max(RESOLVED, float(1.4826 * np.median(np.abs(second - np.median(second))) / np.sqrt(6.0)))
