"""Pictures of a report: panels below each other over one abscissa, written as SVG that scales with the page.

Written by hand: a library of figures takes 0.4 s to load and as long to draw, a fifth of a diagnosis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sher3_diagnosis.channel import Array

REAL, NOMINAL, CORRECTED, FLOOR = "#1f2937", "#d97706", "#0f766e", "#94a3b8"
INK, SOFT, GRID = "#374151", "#4b5563", "#e5e7eb"
"""Colour of labels, of the numbers of an axis, and of the lines behind the curves."""
WIDTH, LEFT, RIGHT, TOP, BOTTOM = 750, 52, 4, 16, 16
"""Of a picture and of the margins around a panel, px."""
MARGIN = 0.06
"""Room above and below the curves, as a share of what they span."""
MOST = 4000
"""Points of a line: more lie closer than a picture that is 32 times enlarged can show."""
TICKS = 7
"""Intervals of an axis at most."""


@dataclass(frozen=True)
class Line:
    """A curve `y` (n,) over `x` (n,); it breaks where a value is missing."""

    x: Array
    y: Array
    colour: str
    label: str


def stepped(x: Array, y: Array, colour: str, label: str) -> Line:
    """Return a line that takes each value (n,) from the point before on."""
    return Line(np.repeat(x, 2)[:-1], np.repeat(y, 2)[1:], colour, label)


@dataclass(frozen=True)
class Panel:
    """Lines over one ordinate.

    Attributes:
        label: of the ordinate.
        height: of the axes, px.
        lines: first drawn first.
        band: half width of a band about zero and its label; None draws none.
    """

    label: str
    height: int
    lines: Sequence[Line]
    band: tuple[float, str] | None = None

    @property
    def range(self) -> tuple[float, float]:
        """Return the ends of the ordinate."""
        half = self.band[0] if self.band else 0.0
        low, high = _span([*(line.y for line in self.lines), np.array([-half, half] if self.band else [])])
        room = MARGIN * (high - low)
        return low - room, high + room


def picture(panels: Sequence[Panel], abscissa: str, title: str) -> str:
    """Return the panels as inline SVG that names itself to a screen reader."""
    across = _span([line.x for panel in panels for line in panel.lines])
    parts, top = [], 0
    for panel in panels:
        parts.append(_panel(panel, across, top + TOP, numbered=panel is panels[-1]))
        top += TOP + panel.height + 6
    high = top + 2 * BOTTOM
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, high - 5, abscissa, INK, "middle"))
    head = f'<svg role="img" aria-label="{escape(title)}" viewBox="0 0 {WIDTH} {high}" font-size="10" fill="none">'
    return head + "".join(parts) + "</svg>"


def _panel(panel: Panel, across: tuple[float, float], top: float, numbered: bool) -> str:
    """Return one panel whose axes begin `top` px below the upper edge; the abscissa is numbered under the last."""
    bottom, right = top + panel.height, WIDTH - RIGHT
    x, y = _scale(across, LEFT, right), _scale(panel.range, bottom, top)
    out = []
    for value, said in ticks(*across):
        out.append(f'<path d="M{x(value):.1f} {top}V{bottom}" stroke="{GRID}"/>')
        out += [_text(x(value), bottom + 13, said, SOFT, "middle")] if numbered else []
    for value, said in ticks(*panel.range):
        out.append(f'<path d="M{LEFT} {y(value):.1f}H{right}" stroke="{GRID}"/>')
        out.append(_text(LEFT - 5, y(value) + 4, said, SOFT, "end"))
    labels = [(line.colour, 1.0, line.label) for line in panel.lines]
    if panel.band is not None:
        half, said = panel.band
        box = f'x="{LEFT}" y="{y(half):.1f}" width="{right - LEFT}" height="{y(-half) - y(half):.1f}"'
        out.append(f'<rect {box} fill="{FLOOR}" opacity="0.25"/>')
        labels.insert(0, (FLOOR, 0.5, said))
    out.append(f'<path d="M{LEFT} {top}V{bottom}H{right}" stroke="#9ca3af"/>')
    for line in panel.lines:
        look = f'stroke="{line.colour}" stroke-width="1.2" stroke-linejoin="round"'
        out.append(f'<path d="{_path(x(line.x), y(line.y))}" {look}/>')
    key = (
        f'<tspan dx="{14 * (i > 0)}" fill="{colour}" opacity="{opacity}">■</tspan><tspan dx="4">{escape(said)}</tspan>'
        for i, (colour, opacity, said) in enumerate(labels)
    )
    out.append(f'<text x="{LEFT}" y="{top - 5}" fill="{INK}">{"".join(key)}</text>')
    middle = f"translate(11,{(top + bottom) / 2:.0f}) rotate(-90)"
    out.append(f'<text transform="{middle}" text-anchor="middle" fill="{INK}">{escape(panel.label)}</text>')
    return "".join(out)


def ticks(low: float, high: float) -> list[tuple[float, str]]:
    """Return round numbers between two ends, and how they are written: steps of 1, 2, 2.5 or 5 times a power of ten."""
    rough = (high - low) / TICKS
    ten = 10.0 ** np.floor(np.log10(rough))
    step = float(next(k * ten for k in (1.0, 2.0, 2.5, 5.0, 10.0) if k * ten >= rough * (1.0 - 1e-9)))
    counted = range(int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9)) + 1)
    return [(k * step, f"{k * step:.6g}".replace("-", "−")) for k in counted]


def _span(values: Sequence[Array]) -> tuple[float, float]:
    """Return the least and the largest of some values; one apart where they are all the same."""
    every = np.concatenate([v[np.isfinite(v)] for v in values])
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 0.0)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _scale(ends: tuple[float, float], first: float, last: float) -> Callable[[Any], Any]:
    """Return what takes values, the two ends to `first` and `last`, px."""
    low, high = ends
    return lambda value: first + (value - low) / (high - low) * (last - first)


def _path(x: Array, y: Array) -> str:
    """Return a line through points (n,) as the data of a path; it begins anew after a missing one."""
    kept = _drawn(y)
    x, y = x[kept], y[kept]
    begins = np.isnan(np.append(np.nan, y)[: len(y)])
    points = zip(x.tolist(), y.tolist(), begins.tolist(), strict=True)
    return "".join(f"{'M' if first else 'L'}{a:.2f} {b:.2f}" for a, b, first in points if b == b)


def _drawn(y: Array) -> NDArray[np.int64]:
    """Return which points (n,) are drawn: all, or of each few the least and the largest, gaps included."""
    every = np.arange(len(y))
    if len(y) <= MOST:
        return every
    few = np.array_split(every, MOST // 2)
    return np.unique([part[end(y[part])] for part in few for end in (np.argmin, np.argmax)])


def _text(x: float, y: float, said: str, colour: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{escape(said)}</text>'
