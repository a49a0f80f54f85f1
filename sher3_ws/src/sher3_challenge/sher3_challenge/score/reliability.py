"""Whether stated probabilities are met: the reliability diagram and the expected calibration error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

BINS = 10
ABREAST = 3
"""Panels of a row."""

Stated = tuple[float, bool]
"""A probability, and whether what it was given for is true."""


@dataclass(frozen=True)
class Bin:
    """Answers that were given about the same probability.

    Attributes:
        stated: mean probability; met: share that was right; n: answers.
    """

    stated: float
    met: float
    n: int


def bins(answers: Sequence[Stated]) -> list[Bin]:
    """Return the answers by their probability, in ten bins; empty ones are left out."""
    if not answers:
        return []
    stated, met = np.array(answers, dtype=float).T
    place = np.minimum((stated * BINS).astype(int), BINS - 1)
    return [
        Bin(float(stated[place == k].mean()), float(met[place == k].mean()), int((place == k).sum()))
        for k in range(BINS)
        if (place == k).any()
    ]


def calibration_error(answers: Sequence[Stated]) -> float:
    """Return the mean difference of stated probability and share met, weighted by the answers in each bin."""
    found = bins(answers)
    total = sum(b.n for b in found)
    return sum(b.n * abs(b.stated - b.met) for b in found) / total if total else 0.0


def diagram(answers: Mapping[str, Sequence[Stated]], path: Path) -> None:
    """Write the reliability diagram, one panel per name, as a picture."""
    from matplotlib.figure import Figure

    rows = -(-max(len(answers), 1) // ABREAST)
    figure = Figure(figsize=(3.4 * ABREAST, 3.4 * rows), layout="constrained")
    panels = figure.subplots(rows, ABREAST, squeeze=False, sharex=True, sharey=True).ravel()
    for axes, (name, given) in zip(panels, answers.items(), strict=False):
        found = bins(given)
        axes.plot([0.0, 1.0], [0.0, 1.0], color="0.7", linewidth=1.0)
        axes.plot([b.stated for b in found], [b.met for b in found], marker="o")
        for b in found:
            axes.annotate(str(b.n), (b.stated, b.met), textcoords="offset points", xytext=(5, -9), fontsize=7)
        axes.set(xlim=(0, 1), ylim=(0, 1))
        axes.set_title(f"{name}: n {len(given)}, error {calibration_error(given):.3f}", fontsize="small")
    for axes in panels[len(answers) :]:
        axes.set_visible(False)
    figure.supxlabel("stated probability")
    figure.supylabel("share that was right")
    figure.savefig(path, dpi=120)
