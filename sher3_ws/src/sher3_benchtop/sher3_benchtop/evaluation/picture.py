"""The grids as the cameras read them, and force against deflection, as the paper's figures 9 to 13 show them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sher3_benchtop.cameras.camera import Reading, view
from sher3_benchtop.cameras.pictures import Shots
from sher3_benchtop.evaluation.evaluate import Cameras
from sher3_benchtop.protocol.plan import ACCURACY, PLANES, REPEATABILITY, RESOLUTION, Grid

MAGNIFIED = {"grid_10mm": 30.0, "grid_2mm": 30.0, "grid_10um": 1.0}


def draw(tests: Mapping[str, Mapping[str, Shots]], path: Path, reading: Reading = "noise", seed: int = 0) -> None:
    """Write a PNG with the tests that were made."""
    figure = Figure(figsize=(11.0, 10.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(3, 3)
    for column, grid in enumerate((ACCURACY, REPEATABILITY, RESOLUTION)):
        for row, plane in enumerate(PLANES):
            if grid.name in tests:
                _grid(axes[row, column], grid, plane, tests[grid.name][plane], reading, seed)
            else:
                axes[row, column].set_axis_off()
    _pushes(axes[2], tests.get("deflection"))
    handles, labels = axes[0, 0].get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
    figure.savefig(path, dpi=110)


def _grid(axes: Any, grid: Grid, plane: str, shots: Shots, reading: Reading, seed: int) -> None:
    wide = grid.name == "grid_10mm"
    scale, unit = (1e6, "um") if grid is RESOLUTION else (1e3, "mm")
    places = Cameras(view("10mm" if wide else "2mm"), reading, seed).read(plane, shots.plane(plane))
    targets = grid.points[shots.target]
    targets = targets - targets.mean(axis=0)
    factor = MAGNIFIED[grid.name]
    axes.plot(*(scale * np.unique(targets, axis=0).T), "k+", ms=12, label="commanded")
    for found, style, name in ((places, "C0o", "read"), (shots.plane(plane), "C3.", "tip")):
        shown = targets + factor * (found - found.mean(axis=0) - targets)
        axes.plot(*(scale * shown.T), style, ms=4, mfc="none", label=name)
    axes.set(
        xlabel=f"{plane[0]} [{unit}]",
        ylabel=f"{plane[1]} [{unit}]",
        title=f"{grid.name}, {plane}, errors x {factor:.0f}",
        aspect="equal",
    )
    axes.margins(0.15)


def _pushes(row: Any, shots: Mapping[str, Shots] | None) -> None:
    for k, (axes, axis) in enumerate(zip(row, "xyz", strict=True)):
        if shots is None:
            axes.set_axis_off()
            continue
        for number in range(5):
            group = shots[f"{axis}{number}"]
            order = np.argsort(group.force)
            moved = group.grasp[:, k] - group.grasp[group.force == 0.0, k].mean()
            axes.plot(group.force[order], 1e6 * moved[order], "o-", ms=3, label=f"place {number + 1}")
        axes.set(xlabel=f"force along {axis} [N]", ylabel="grasping point [um]", title=f"deflection along {axis}")
        axes.legend(fontsize=7)
