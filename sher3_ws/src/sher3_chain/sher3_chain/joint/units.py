"""Units that slip: millimetres recorded as metres, degrees as radians."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import FURTHEST

from sher3_chain.joint.description import Axis

SLIPS = {"linear": (1e3, "mm recorded as m"), "rotary": (180.0 / np.pi, "deg recorded as rad")}
"""Motion -> factor of its usual wrong unit, and that slip in words."""
SLIP_TOLERANCE = 1.25
"""Factor within which a ratio of two signals counts as that of a wrong unit."""
BEYOND = 0.1
"""Share of the range by which a position may leave it: stated ranges are rounded."""
COUNTS_MOVED = 100.0
"""Travel in counts from which two signals of one axis can be compared in size."""


def check_units(axis: Axis, signals: dict[str, Array], run: str, over: float = 0.0) -> None:
    """Refuse positions recorded in another unit than stated.

    Args:
        axis: as described.
        signals: of it, (n,) each, SI units.
        run: name, for messages.
        over: range within which the position was recorded before its wraps were joined; 0: there were none.

    They leave the axis' range, or are 1000 (mm for m) or 57.3 (deg for rad) times another position of the axis.

    Raises:
        MachineError: a unit slips.
    """
    position = signals["position"]
    if not 0.0 < over <= 2.0 * FURTHEST[axis.motion] or axis.range is not None:  # else it lay within as recorded
        _check_range(axis, position, run)
    moves = np.ptp(position) > COUNTS_MOVED * axis.encoder_resolution
    for other in ("reference", "load"):
        if moves and other in signals and np.ptp(signals[other]) > 0.0:
            ratio = float(np.ptp(signals[other]) / np.ptp(position))
            factor, slip = SLIPS[axis.motion]
            if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(SLIP_TOLERANCE):
                larger = other if ratio > 1.0 else "position"
                raise MachineError(
                    f"{run}: {axis.name}.{larger}: likely {slip}",
                    value=f"{other} spans {ratio:.4g} times the position",
                    limit="1",
                    remedy="correct the units in the description",
                )


def _check_range(axis: Axis, position: Array, run: str) -> None:
    if axis.range is None and axis.motion == "rotary" and axis.signals.position.unit != "rad":
        return  # of degrees or counts nothing was taken for radians, and a motor may well make a hundred turns
    lowest, highest = axis.range or (-FURTHEST[axis.motion], FURTHEST[axis.motion])
    worst = float(position[np.argmax(np.abs(position))])
    span = max(abs(lowest), abs(highest))
    if lowest - BEYOND * span <= worst <= highest + BEYOND * span:
        return
    factor, slip = SLIPS[axis.motion]
    likely = f"; likely {slip}" if abs(worst) / factor <= (1.0 + BEYOND) * span else ""
    raise MachineError(
        f"{run}: {axis.name}.position leaves the range of the axis{likely}",
        value=f"{worst:.4g}",
        limit=f"{lowest:g} .. {highest:g}",
        remedy="convert it, correct the unit in the description, or state the axis' range",
    )
