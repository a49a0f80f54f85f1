"""A small plot of the last seconds as SVG text."""

from __future__ import annotations

from html import escape

import numpy as np
from numpy.typing import NDArray

WINDOW = 20.0
"""Seconds that path and plots go back."""
WIDTH, HEIGHT = 360, 96
LEFT, TOP, BOTTOM = 8, 24, 82
MOST_POINTS = 300
"""A point for each pixel or so."""


def plot_svg(seconds: NDArray[np.float64], values: NDArray[np.float64], title: str, unit: str, colour: str) -> str:
    """Return the plot of values (n,), none negative, over seconds (n,) before now; the scale is written beside it."""
    top = scale_for(float(values.max()))
    thin = slice(None, None, max(1, len(values) // MOST_POINTS))
    x = WIDTH - 4 + seconds[thin] / WINDOW * (WIDTH - 4 - LEFT)
    y = BOTTOM - values[thin] / top * (BOTTOM - TOP)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    grey = 'fill="#66727f" font-size="11"'
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="100%" font-family="system-ui, DejaVu Sans, sans-serif">'
        f'<text x="{LEFT}" y="14" font-size="12" font-weight="600" fill="#1d2733">{escape(title)}</text>'
        f'<text x="{WIDTH - 4}" y="14" text-anchor="end" {grey}>to {top:g} {escape(unit)}</text>'
        f'<path d="M{LEFT} {TOP}H{WIDTH - 4}M{LEFT} {BOTTOM}H{WIDTH - 4}" stroke="#dde2e7"/>'
        f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.6"/>'
        f'<text x="{LEFT}" y="{HEIGHT - 2}" {grey}>{WINDOW:g} s ago</text>'
        f'<text x="{WIDTH - 4}" y="{HEIGHT - 2}" text-anchor="end" {grey}>now</text></svg>'
    )


def scale_for(largest: float) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that holds the largest value, at least 0.1."""
    ten = 10.0 ** np.floor(np.log10(max(largest, 0.1)))
    return next(float(round(k * ten, 9)) for k in (1, 2, 5, 10) if round(k * ten, 9) >= largest)
