"""Places that nobody measured: a log that repeats what was asked, number for number, some rows later.

Hands without encoders and simulators that are set from place to place are logged so. Such a joint follows exactly, one
row late, and says nothing of a machine.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.roles import Place, values_of
from sher3_machines.intake.tables import SAMPLES, Tables

ROWS = (1, 2)
"""Rows by which a log is late that a loop writes: what it asked in its last step, or in the one before."""
ALIKE = 0.99
"""Share of the samples in motion that repeat what was asked."""
COUNTS = 1.5
"""Counts that a sample in motion has gone at least: an encoder that goes count by count agrees by chance."""


def measured(groups: dict[str, dict[str, Place]], tables: Tables, guesses: list[str]) -> dict[str, dict[str, Place]]:
    """Return the signals of the axes that were measured: axis -> signal -> place, all where none was."""
    servos = {axis: x for axis, x in groups.items() if "reference" in x and "effort" not in x}
    pairs = {axis: (values_of(x["position"], tables), values_of(x["reference"], tables)) for axis, x in servos.items()}
    least = 1 if any(echo(*pair) for pair in pairs.values()) else SAMPLES  # what logs one joint so logs others so
    rows = {axis: k for axis, pair in pairs.items() if (k := echo(*pair, least))}
    if len(rows) == len(groups):
        return groups
    guesses += [
        f"{axis}: left out, because {groups[axis]['position'][0]!r} is {groups[axis]['reference'][0]!r} {k} rows "
        "before, number for number: it repeats what was asked, and nothing was measured"
        for axis, k in rows.items()
    ]
    return {axis: signals for axis, signals in groups.items() if axis not in rows}


def echo(position: Array, asked: Array, least: int = SAMPLES) -> int:
    """Return the rows (of `ROWS`) by which positions (n,) repeat what was asked, (n,); 0 where they do not.

    `least`: samples in motion from which it is told.
    """
    steps = np.abs(np.diff(position))
    count = COUNTS * min(steps[steps > 0.0], default=0.0)
    for k in ROWS if position.shape == asked.shape else ():
        moving = np.flatnonzero(steps[k - 1 :] > count)
        if len(moving) >= least and np.mean(position[k:][moving] == asked[:-k][moving]) > ALIKE:
            return k
    return 0
