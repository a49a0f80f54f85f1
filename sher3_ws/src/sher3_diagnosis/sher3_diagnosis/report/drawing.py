"""Colours and figures that all pictures of a report share."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from html import escape
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

REAL, NOMINAL, CORRECTED, FLOOR = "#1f2937", "#d97706", "#0f766e", "#94a3b8"
INK, TOGETHER = "#111827", "#155e75"
"""Colour of marks and numbers, and of the bars of all causes taken together."""
GRID = "#e5e7eb"
STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Inter", "Segoe UI", "Helvetica", "Arial", "DejaVu Sans", "sans-serif"],
    "font.size": 9,
    "axes.edgecolor": "#9ca3af",
    "axes.labelcolor": "#374151",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "xtick.color": "#4b5563",
    "ytick.color": "#4b5563",
    "legend.frameon": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "sher3",
    # A name may hold dollars; no label of ours is a formula.
    "text.parse_math": False,
}
"""Matplotlib settings in force while a report is drawn."""
ABOVE: dict[str, Any] = {
    "loc": "lower left",
    "bbox_to_anchor": (0.0, 0.99),
    "ncols": 3,
    "fontsize": 8,
    "borderpad": 0.1,
}
"""A legend above its axes, where it hides no line, and on the left, where a narrow screen begins to show it."""
MARGINS: dict[str, Any] = {"x": 0.005, "y": 0.06}
"""Room around the lines, as shares of the axes."""
WIDTH = 10.4
"""Of a figure, inches."""


def figure(rows: int, height: float, **options: Any) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure of `height` x `WIDTH` inches with `rows` panels below each other, made for `to_svg`."""
    made = Figure(figsize=(WIDTH, height), layout="constrained")
    axes = made.subplots(rows, 1, squeeze=False, **options)[:, 0]
    for ax in axes:
        ax.spines[["top", "right"]].set_visible(False)
    return made, list(axes)


def to_svg(made: Figure, title: str) -> str:
    """Return a figure as inline SVG that scales with the page and names itself to a screen reader."""
    buffer = io.StringIO()
    made.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None}, transparent=True)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r'width="[^"]*pt" height="[^"]*pt"', "", text, count=1)
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    return text.replace("<svg", f'<svg role="img" aria-label="{escape(title)}"', 1)
