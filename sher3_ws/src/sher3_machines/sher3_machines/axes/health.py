"""Channels that say nothing or in a wrong scale: an encoder that reads 0.0, an effort that stays at one value.

A channel that is not connected must not become a cause. It is named and left out; the other channels are judged.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array, Mask

from sher3_machines.axes.description import Axis
from sher3_machines.axes.quantities.units import COUNTS_MOVED
from sher3_machines.axes.record import AxesRun
from sher3_machines.thresholds import ALIKE, DEAD, FOLLOWS, SCALED

ANSWERS = ("effort", "load")
"""Signals that must change while the axis moves; a reference or a command may well be constant."""
OTHERS = ("reference", "load")
"""Signals whose motion shows that a position that does not move is dead."""
AT_THE_END = 0.9
"""Share of its largest reading above which a constant reading is a limit and no dead channel."""


def dead_channels(run: AxesRun, axis: Axis) -> Mapping[str, str]:
    """Return the signals of an axis that say nothing, each with a sentence that names it."""
    found = run.signals[axis.name]
    position, out = found["position"], {}
    travel = float(np.ptp(position))
    least = COUNTS_MOVED * axis.encoder_resolution
    if travel == 0.0:
        moved = [k for k in OTHERS if k in found and np.ptp(found[k]) > least]
        if moved == ["load"] and ("applied" in found or "reference" in found):
            moved = []  # a held axis rests while a load moves what is behind it
        if moved:
            still = f"reads {position[0]:.6g} throughout while {moved[0]} moves by {np.ptp(found[moved[0]]):.3g}"
            out["position"] = _sentence(run, axis, "position", still, "nothing is judged")
        return out
    if travel < least:
        return out
    moving = np.abs(np.gradient(position)) > 0.5 * axis.encoder_resolution
    for name in ANSWERS:
        if name in found and moving.any():
            what: str | None = stuck(found[name], moving)
            if what is None and name == "load" and np.ptp(found[name]) < FOLLOWS * travel:
                what = f"moves by {np.ptp(found[name]):.3g} while the axis moves by {travel:.3g}: a dead channel"
            what = wrong_scale(found[name], position) if what is None and name == "load" else what
            if what is not None:
                out[name] = _sentence(run, axis, name, what, "it is left out")
    return out


def stuck(signal: Array, moving: Mask) -> str | None:
    """Return how a signal (n,) stays at one value while the axis moves; None where it does not."""
    values, counts = np.unique(signal[moving], return_counts=True)
    common = float(values[int(np.argmax(counts))])
    share = float(counts.max()) / int(moving.sum())
    limit = len(values) > 1 and abs(common) > AT_THE_END * float(np.abs(signal).max())
    if share < DEAD or limit:
        return None
    return f"reads {common:.6g} in {share:.0%} of the samples in which the axis moves: a dead channel"


def wrong_scale(load: Array, position: Array) -> str | None:
    """Return by how much another scale a second encoder moves with the axis, (n,) each; None where it is the same."""
    about = position - position.mean()
    ratio = float(about @ load / (about @ about))
    alike = abs(float(np.corrcoef(load, position)[0, 1])) > ALIKE
    if not alike or abs(ratio - 1.0) < SCALED:
        return None
    return f"moves {ratio:.4g} times as far as the axis: state its `factor`"


def without_dead(run: AxesRun, axis: Axis) -> AxesRun:
    """Return the run without the dead signals of an axis."""
    dead = dead_channels(run, axis)
    if not dead:
        return run
    kept = {k: x for k, x in run.signals[axis.name].items() if k not in dead}
    return AxesRun(run.name, run.period, {**run.signals, axis.name: kept}, run.notes)


def _sentence(run: AxesRun, axis: Axis, signal: str, what: str, so: str) -> str:
    return f"{run.name}: {axis.name}.{signal} {what}; {so}"
