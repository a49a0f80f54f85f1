"""Colours, figures and numbers that all sections share."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

REAL, NOMINAL, CORRECTED, FLOOR = "#1f2937", "#d97706", "#0f766e", "#94a3b8"
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
}
"""Matplotlib settings in force while a report is drawn."""
_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
_PLAIN = frozenset({"1", "", "1/K", "1/s", "%"})
STAGE_NAMES = {
    "transport": "Transport",
    "controller": "Controller",
    "drive": "Drive",
    "motor_mechanics": "Motor mechanics",
    "transmission": "Transmission",
    "mechanism": "Mechanism",
    "structure": "Structure",
    "sensing": "Sensing",
}
"""Stages as the report prints them."""


def words(identifier: str) -> str:
    """Return an effect or family id in words: `coulomb_friction` -> `Coulomb friction`."""
    text = identifier.replace("_", " ")
    proper = {"coulomb friction": "Coulomb friction", "stribeck friction": "Stribeck friction"}
    return proper.get(text, text[:1].upper() + text[1:])


def place(actuator: str) -> str:
    """Return an actuator or place in words."""
    return {"all": "all axes", "tip": "tip", "force_sensor": "force sensor"}.get(actuator, actuator.replace("_", " "))


def quantity(value: float | None, unit: str) -> str:
    """Return a number with three digits, an SI prefix and its unit."""
    if value is None or not math.isfinite(value):
        return "–"
    shown = unit.replace("*", "·")
    if unit in _PLAIN:
        return f"{value:.3g}" + ("" if unit in ("1", "") else f" {shown}")
    if unit.startswith("kg"):
        value, shown, unit = value * 1e3, shown[1:], unit[1:]
    size = abs(value)
    scale, prefix = next(((s, p) for s, p in _PREFIXES if size >= 0.9995 * s), (1.0, ""))
    number = value / scale
    digits = f"{number:.0f}" if abs(number) >= 99.95 else f"{number:.3g}"
    return f"{digits} {prefix}{shown}"


def range_text(low: float | None, high: float | None, unit: str) -> str:
    """Return an interval, or why there is none."""
    if low is None or high is None:
        return "too few runs"
    return f"{quantity(low, unit)} … {quantity(high, unit)}"


def share(value: float | None) -> str:
    """Return a closure as a percentage; rounding never makes a part look like the whole."""
    if value is None:
        return "–"
    text = f"{100 * value:.0f} %"
    return "> 99 %" if text == "100 %" and value < 1.0 else text


def ratio_text(ratio: float) -> str:
    """Return a gap over floor."""
    return f"{ratio:.1f}" if ratio < 100 else (f"{ratio:.0f}" if ratio < 1000 else "≫ 1000")


def figure(rows: int, height: float, width: float = 10.4, **options: Any) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure with `rows` panels below each other, made for `to_svg`."""
    made = Figure(figsize=(width, height), layout="constrained")
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
    return text.replace("<svg", f'<svg role="img" aria-label="{title}"', 1)
