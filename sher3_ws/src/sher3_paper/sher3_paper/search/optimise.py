"""The exhaustive search of the paper, its Pareto front, and the same over a fine grid on many cores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from sher3_kinematics.link_law import LinkLaw

from sher3_paper.errors import BadData, InfeasibleDesign
from sher3_paper.search.constraints import Constraints, Quantities, Workspace, quantities
from sher3_paper.search.design import Design, Reading, leg_offset
from sher3_paper.search.kernel import evaluate

Floats = NDArray[np.float64]

PAPER_LAW = LinkLaw(a=3.7e-6, b=0.71, force_floor=0.0)
"""The fitted curve of the paper, without springs, which its optimisation used."""
TORQUE = 1.0
"""Moment [N m] at which T_c is taken; the paper does not state it."""


@dataclass(frozen=True)
class Search:
    """Evaluated designs, each array (n,).

    Attributes:
        link_length, leg_width: [m].
        inclination: [rad].
        index: global conditioning index, mean of sigma_min / sigma_max; NaN out of reach.
        compliance: mean torsional compliance [rad/(N m)]; NaN out of reach.
        values: constrained quantities.
        reading: of the radii.
    """

    link_length: Floats
    leg_width: Floats
    inclination: Floats
    index: Floats
    compliance: Floats
    values: Quantities
    reading: Reading

    def __len__(self) -> int:
        return len(self.index)

    def design(self, k: int) -> Design:
        """Return design k."""
        return Design(float(self.link_length[k]), float(self.leg_width[k]), float(self.inclination[k]))

    def find(self, design: Design) -> int:
        """Return the number of a design of the grid, or raise InfeasibleDesign."""
        distance = np.abs(self.link_length - design.link_length) + np.abs(self.leg_width - design.leg_width)
        distance = distance + np.abs(self.inclination - design.inclination)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1e-9:
            remedy = f"the nearest is {self.design(nearest)}"
            raise InfeasibleDesign("not in the grid", design=design, value=str(design), limit="the grid", remedy=remedy)
        return nearest

    def rank(self, k: int, among: NDArray[np.bool_]) -> tuple[int, int]:
        """Return the place of design k among the flagged designs by index / compliance, from 1, and their number."""
        score = np.where(among, self.index / self.compliance, -np.inf)
        return int((score > score[k]).sum()) + 1, int(among.sum())

    def dominating(self, k: int, among: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return the numbers of the flagged designs better than design k in both objectives."""
        better = (self.index >= self.index[k]) & (self.compliance <= self.compliance[k])
        better &= (self.index > self.index[k]) | (self.compliance < self.compliance[k])
        return np.flatnonzero(better & among)

    def pareto(self, among: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return the numbers of the flagged designs that no flagged design dominates, by rising compliance."""
        candidates = np.flatnonzero(among & np.isfinite(self.index))
        order = candidates[np.lexsort((-self.index[candidates], self.compliance[candidates]))]
        best = np.maximum.accumulate(np.concatenate(([-np.inf], self.index[order])))[:-1]
        return order[self.index[order] > best]


def paper_grid() -> tuple[Floats, Floats, Floats]:
    """Return L 60:2:90 mm, w 25:5:40 mm, psi 18:1:32 deg as arrays (960,), [m, m, rad]."""
    return grid(np.linspace(0.060, 0.090, 16), np.linspace(0.025, 0.040, 4), np.radians(np.linspace(18.0, 32.0, 15)))


def grid(lengths: Floats, widths: Floats, inclinations: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the Cartesian product of three parameter lists as three flat arrays."""
    if min(len(lengths), len(widths), len(inclinations)) == 0:
        raise BadData("grid", value="empty", remedy="give at least one value of each parameter")
    mesh = np.meshgrid(lengths, widths, inclinations, indexing="ij")
    return mesh[0].ravel(), mesh[1].ravel(), mesh[2].ravel()


def law_array(law: LinkLaw) -> Floats:
    """Return the link law as the compiled code takes it."""
    return np.array([law.a * law.factor, law.b, law.force_floor**2])


def search(
    parameters: tuple[Floats, Floats, Floats] | None = None,
    reading: Reading = "circumradius",
    poses: int = 432,
    torque: float = TORQUE,
    law: LinkLaw = PAPER_LAW,
    workspace: Workspace | None = None,
) -> Search:
    """Evaluate designs, by default the paper's 960, over the workspace.

    Args:
        parameters: L, w, psi (n,) [m, m, rad].
        reading: of the radii.
        poses: positions over the disc per design; the height drops out with vertical rails.
        torque: moment [N m] at which T_c is taken.
        law: link law.
        workspace: cylinder to cover.
    """
    length, width, psi = paper_grid() if parameters is None else parameters
    if poses < 1 or not torque > 0:
        raise BadData("poses and torque [N m]", value=(poses, torque), limit=">= 1 and > 0", remedy="correct them")
    space = Workspace() if workspace is None else workspace
    offset = leg_offset(length, width, psi, reading)
    index, compliance = evaluate(length, width, offset, space.poses(poses), torque, law_array(law))
    values = quantities(length, width, psi, reading, space)
    lost = ~values.reaches
    index[lost], compliance[lost] = np.nan, np.nan
    return Search(length, width, psi, index, compliance, values, reading)


def fine_grid(designs: int) -> tuple[Floats, Floats, Floats]:
    """Return at least `designs` designs over the paper's ranges, psi and L four times as fine as w."""
    if not 1 <= designs <= 50_000_000:
        raise BadData("number of designs", value=designs, limit="1 to 50 000 000", remedy="choose fewer")
    step = max(2, int(np.ceil((designs * 4) ** (1 / 3))))
    widths = max(2, int(np.ceil(designs / step**2)))
    ends = np.linspace(0.060, 0.090, step), np.linspace(0.025, 0.040, widths), np.radians(np.linspace(18, 32, step))
    return grid(*ends)


def search_parallel(
    parameters: tuple[Floats, Floats, Floats],
    reading: Reading = "circumradius",
    poses: int = 432,
    jobs: int = 1,
    dask: str | None = None,
    chunk: int = 20_000,
) -> Search:
    """Evaluate many designs in chunks, on `jobs` processes or on the Dask cluster at the address `dask`."""
    count = len(parameters[0])
    pieces = [tuple(values[i : i + chunk] for values in parameters) for i in range(0, count, chunk)]
    if dask is not None:
        from distributed import Client

        with Client(dask, timeout="10s") as client:
            parts = client.gather(client.map(_search_piece, pieces, reading=reading, poses=poses, pure=False))
    else:
        parts = Parallel(n_jobs=jobs)(delayed(_search_piece)(piece, reading, poses) for piece in pieces)
    return _joined(parts, reading)


def _search_piece(piece: tuple[Floats, Floats, Floats], reading: Reading, poses: int) -> Search:
    return search(piece, reading, poses)


def _joined(parts: Sequence[Search], reading: Reading) -> Search:
    def column(name: str) -> Floats:
        return np.concatenate([getattr(part, name) for part in parts])

    def value(name: str) -> Floats:
        return np.concatenate([getattr(part.values, name) for part in parts])

    names = ("reaches", "clearance", "midplane_clearance", "stroke", "swing", "cone")
    values = Quantities(**{name: value(name) for name in names})  # type: ignore[arg-type]
    design = [column(name) for name in ("link_length", "leg_width", "inclination")]
    return Search(design[0], design[1], design[2], column("index"), column("compliance"), values, reading)


def best(found: Search, constraints: Constraints) -> dict[str, int]:
    """Return the feasible designs best by index, by compliance, by their ratio and by their normalised difference.

    Raises:
        InfeasibleDesign: no design of the grid meets the constraints.
    """
    feasible = np.flatnonzero(constraints.met(found.values))
    if len(feasible) == 0:
        raise InfeasibleDesign(
            "no design meets the constraints", design="grid", value=0, limit=">= 1", remedy="relax a constraint"
        )
    index, compliance = found.index[feasible], found.compliance[feasible]
    gain = (index - index.min()) / max(np.ptp(index), 1e-300)
    cost = (compliance - compliance.min()) / max(np.ptp(compliance), 1e-300)
    return {
        "largest GCI": int(feasible[np.argmax(index)]),
        "least T_c": int(feasible[np.argmin(compliance)]),
        "largest GCI / T_c": int(feasible[np.argmax(index / compliance)]),
        "largest normalised GCI - T_c": int(feasible[np.argmax(gain - cost)]),
    }
