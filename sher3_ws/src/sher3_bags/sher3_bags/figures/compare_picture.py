"""A picture of a comparison: the difference of two runs over time, a panel a quantity, a trace an axis."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sher3_bags.errors import BagError
from sher3_bags.figures.compare import AxisResidual, Comparison
from sher3_bags.figures.report import quantity
from sher3_bags.run import Run

FIRST = ("measured_cp", "measured_js", "force/measured_cf", "drives/measured_js", "setpoint_js", "tracker/measured_cp")
"""Topics that are drawn before others."""
MOST = 6
"""Panels of the picture."""
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9")
_MOST_POINTS = 4000


def draw_comparison(a: Run, b: Run, comparison: Comparison, path: str | Path) -> Path:
    """Draw b less a over the time of a, each axis in its own scale; return the path.

    Raises:
        BagError: nothing was compared, or the file cannot be written in this format.
    """
    found = [
        (topic, column, axes) for topic, columns in comparison.residuals.items() for column, axes in columns.items()
    ]
    shown = sorted(found, key=lambda row: FIRST.index(row[0]) if row[0] in FIRST else len(FIRST))[:MOST]
    if not shown:
        raise BagError("nothing to draw: no quantity is in both runs", path=comparison.b)
    rows = math.ceil(len(shown) / 2)
    figure = Figure(figsize=(13, 1.0 + 2.9 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    lag = "" if comparison.lag is None else f", b later by {quantity(comparison.lag, 's')} (median)"
    names = f"b ({Path(comparison.b).name}) less a ({Path(comparison.a).name})"
    title = f"{names}: aligned by {comparison.alignment}, {comparison.overlap:.2f} s in common{lag}"
    figure.suptitle(title, fontsize=12, parse_math=False)
    with mpl.rc_context({"font.size": 9}):
        for k, (topic, column, axes) in enumerate(shown):
            _panel(figure.add_subplot(rows, 2, k + 1), a, b, comparison.shift, topic, column, axes)
    target = Path(path)
    try:
        figure.savefig(target, dpi=110)
    except (OSError, ValueError) as error:
        remedy = "name a writable .png, .pdf or .svg"
        raise BagError(f"cannot be drawn ({error})", path=target, remedy=remedy) from error
    return target


def _panel(panel: Any, a: Run, b: Run, shift: int, topic: str, column: str, axes: tuple[AxisResidual, ...]) -> None:
    one, two = a[topic], b[topic]
    seconds, others = (one.stamp - a.start) * 1e-9, (two.stamp + shift - a.start) * 1e-9
    inside = (seconds >= others[0]) & (seconds <= others[-1])
    seconds = seconds[inside]
    thin = slice(None, None, max(1, len(seconds) // _MOST_POINTS))
    values = getattr(one, column).reshape(len(one), -1)[inside], getattr(two, column).reshape(len(two), -1)
    for k, axis in enumerate(axes):
        if k >= values[0].shape[1]:
            break
        difference = np.interp(seconds, others, values[1][:, k]) - values[0][:, k]
        panel.plot(seconds[thin], 0.48 * difference[thin] / max(axis.max, 1e-30) - k, lw=0.7, color=_COLOURS[k % 5])
        panel.axhline(-k, lw=0.4, color="0.6")
    names = [f"{axis.axis}\n±{quantity(axis.max, axis.unit)}" for axis in axes]
    panel.set_yticks([-k for k in range(len(axes))], names, fontsize=8)
    panel.set_title(f"{topic}, {column}: b less a, own scales")
    panel.set_xlabel("time [s]")
