"""What a place follows, of several columns that are asked of it: a target, and the profile by which it is reached."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sher3_machines.drafting.roles import Place
from sher3_machines.drafting.unnamed import line_residual, values_at
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables


def followed(placed: Mapping[Place, tuple[str, str]], tables: Tables) -> dict[Place, tuple[str, str]]:
    """Return the signals with one reference for each place: of several in its table, the one that it is most like.

    A drive is told where to go, and by a profile how to go there: the place follows the profile. Units, zeros and the
    sense of either do not count.
    """
    out = dict(placed)
    for position, (signal, axis) in placed.items():
        if signal != "position":
            continue
        table, role = table_of(position[0]), ("reference", axis)
        asked = [p for p, what in placed.items() if what == role and table_of(p[0]) == table]
        for p in sorted(asked, key=lambda p: _unlike(position, p, tables))[1:]:
            out.pop(p, None)
    return out


def _unlike(place: Place, other: Place, tables: Tables) -> float:
    """Return what a line over one column (n,) leaves of the variance of another one, as a share; 1 where it stands."""
    x, y = values_at(place, tables), values_at(other, tables)
    rows = np.isfinite(x) & np.isfinite(y) if len(x) == len(y) else np.zeros(0, dtype=bool)
    if not rows.any() or not (np.ptp(x[rows]) > 0.0 and np.ptp(y[rows]) > 0.0):
        return 1.0
    return line_residual(x[rows], y[rows])[0]
