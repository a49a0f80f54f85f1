"""The bench-top figures as text: printed beside ours, with the definitions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_paper.sections.benchtop import quantities

from sher3_benchtop.cameras.camera import READINGS, Reading, view
from sher3_benchtop.evaluation.evaluate import Figures

DEFINITIONS = """\
Definitions
  noise, field  what the two cameras read if their printed RMS error (18.4 um in the 10 mm view, 4.9 um in the 2 mm
                view, units corrected, along each image axis) is made anew at every reading, or is a smooth distortion
                of the view; both with the printed pixels; median over 64 random cameras. tip: no camera.
  accuracy      |measured - intended| of all motions by one spacing, mean and standard deviation (n - 1) over the
                pairs of points in line. ISO 9283 has no such figure; its pose accuracy AP is the distance of the mean
                of a point's visits from the point, here after shifting the grid onto its mean. Worst point.
  repeatability standard deviation (n - 1) of the visits of a point along an axis, mean over the points; z is the
                mean of both planes. ISO 9283: RP = mean distance from the barycentre + 3 standard deviations, of 30
                visits in space; here of the visits made, in the plane of a camera. Worst point.
  compliance    least-squares slope of the grasping point's displacement over the force, along the force.
  rotation      motion of the tip for 0.02 deg, and the standard deviation at its ends."""


def as_text(figures: Mapping[Reading, Figures], title: str) -> str:
    """Return the tables: what the paper prints, then what it does not."""
    names = dict.fromkeys(name for found in figures.values() for name in found)
    printed = {name: value for name, _, value in quantities()}
    lines = [title, f"  {'':46s} {'paper':>8s}" + "".join(f"{name:>9s}" for name in READINGS)]
    for name in [*(n for n in printed if n in names), *(n for n in names if n not in printed)]:
        paper = _short(name, printed[name]) if name in printed else "-"
        cells = "".join(f"{_short(name, figures[r][name], r):>9s}" for r in READINGS)
        lines.append(f"  {name:46s} {paper:>8s}{cells}")
    return "\n".join([*lines, "  lengths in um, compliances in um/N; * less than a pixel", "", DEFINITIONS])


def _short(name: str, value: float, reading: Reading = "noise") -> str:
    """Return the number, marked where a camera cannot tell it from zero."""
    below = reading != "tip" and "repeatability" in name and value < 1e6 * view("2mm").pixel
    return f"{value:.2f}{'*' if below else ''}"


def spread_text(spread: Mapping[str, np.ndarray], robots: int) -> str:
    """Return the accuracy table over many robots as built."""
    printed = {name: value for name, _, value in quantities()}
    lines = [
        f"{robots} robots as built, true tip at rest [um]",
        f"  {'':46s} {'paper':>8s} {'5 %':>8s}{'50 %':>8s}{'95 %':>8s}",
    ]
    for name, (low, middle, high) in spread.items():
        paper = f"{printed[name]:8.1f}" if name in printed else f"{'-':>8s}"
        lines.append(f"  {name:46s} {paper} {low:8.1f}{middle:8.1f}{high:8.1f}")
    return "\n".join(lines)


def flat(figures: Mapping[Reading, Figures]) -> Figures:
    """Return the figures as one flat object: bare names for the first reading, `field/` and `tip/` before others.

    Bare names are what `sher3 paper --benchtop` reads.
    """
    first, *others = READINGS
    found = dict(figures[first])
    for reading in others:
        found |= {f"{reading}/{name}": value for name, value in figures[reading].items()}
    return found
