"""Runs parted into folds: a formula is found on the runs of some and scored on those of the others."""

from __future__ import annotations

from collections.abc import Sequence

FOLDS = 3
"""Folds: each holds repeats of what the others have too, and whatever was recorded once only in one of them."""


def folds(excitations: Sequence[str]) -> list[list[int]]:
    """Return the runs of every fold: repeats of one excitation are dealt to different folds."""
    order = sorted(range(len(excitations)), key=lambda r: (excitations[r], r))
    return [sorted(order[k::FOLDS]) for k in range(min(FOLDS, len(order)))]
