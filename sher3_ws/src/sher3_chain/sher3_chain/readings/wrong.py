"""Channels that say nothing, fall silent or are in a wrong scale: an encoder that reads 0.0, an effort of one value.

A channel that is not connected must not become a cause. It is named and left out; the other channels are judged.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array, Mask

from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.joint.units import COUNTS_MOVED
from sher3_chain.readings.level import off
from sher3_chain.thresholds import ALIKE, DEAD, FOLLOWS, LONGEST, SCALED, STAYS

ANSWERS = ("effort", "load")
"""Signals that must change while the axis moves; a reference or a command may well be constant."""
OTHERS = ("reference", "load")
"""Signals whose motion shows that a position that does not move is dead."""
HALF = 0.5
"""Share of the travel from which a load that rests is no play's, however the motor went before."""
RELATED = 0.7
"""Correlation of two encoders of one axis below which one of them reads something else: more than half of its power is
not that of the axis."""
LEFT = 0.25
"""Share of the samples in motion that must be left beside those at which a drive is off, for it to be judged there."""
AT_THE_END = 0.9
"""Share of its largest reading above which a constant reading is a limit and no dead channel."""


def wrong_readings(run: AxesRun, axis: Axis) -> Mapping[str, str]:
    """Return the signals of an axis that are wrong in themselves, each with a sentence that names it."""
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
            live = moving & ~off(found[name]) if name == "effort" else moving
            what = stuck(found[name], live if live.sum() > LEFT * moving.sum() else moving)
            what = None if name == "effort" and set_in_steps(found[name]) else what
            if what is None and name == "load" and np.ptp(found[name]) < FOLLOWS * travel:
                what = f"moves by {np.ptp(found[name]):.3g} while the axis moves by {travel:.3g}: a dead channel"
            what = wrong_scale(found[name], position) if what is None and name == "load" else what
            if what is None and name == "load" and "applied" not in found:
                what = unrelated(found[name], position)
            what = flat(found[name], position) if what is None and name == "load" else what
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


def set_in_steps(effort: Array) -> bool:
    """Return whether an effort (n,) was set in steps: levels that are held for long are nearly all of it.

    It may stay at one level for half of a record and is not dead; a dead channel has one level, and flickers beside it.
    """
    held = stays(effort)
    levels = {float(effort[first]) for first, _ in held}
    return len(levels) > 1 and sum(last - first for first, last in held) > AT_THE_END * len(effort)


def wrong_scale(load: Array, position: Array) -> str | None:
    """Return by how much another scale a second encoder moves with the axis, (n,) each; None where it is the same."""
    about = position - position.mean()
    ratio = float(about @ load / (about @ about))
    alike = abs(float(np.corrcoef(load, position)[0, 1])) > ALIKE
    if not alike or abs(ratio - 1.0) < SCALED:
        return None
    return f"moves {ratio:.4g} times as far as the axis: state its `factor`"


def unrelated(load: Array, position: Array) -> str | None:
    """Return how little a second encoder follows the axis, (n,) each; None where it does.

    Play, springs and delays leave most of a motion as it is; what has nothing of it is another quantity.
    """
    alike = float(np.corrcoef(load, position)[0, 1])
    return f"does not follow the axis (correlation {alike:.2f}): another quantity" if abs(alike) < RELATED else None


def flat(load: Array, position: Array) -> str | None:
    """Return over how much of the travel a second encoder stays at one reading, (n,) each; None where it does not."""
    share = stays_over(load, position)
    return f"stays at one reading while the axis moves over {share:.0%} of its travel: flat" if share > STAYS else None


def stays_over(load: Array, position: Array) -> float:
    """Return the share of an axis' travel over which a second encoder stays at one reading, (n,) each.

    Behind a play or at a reversal the load rests too, but only after the motor has turned round. A motor that goes on
    in its direction takes its load along: a rest counts where the motor went on, or over more than half of the travel.
    """
    travel, most = max(float(np.ptp(position)), np.finfo(float).tiny), 0.0
    for first, last in stays(load):
        stay = position[first:last]
        before = np.flatnonzero(position[:first] != position[first])
        direction = float(np.sign(position[first] - position[before[-1]])) if len(before) else 0.0
        onward, whole = float(np.max(direction * (stay - stay[0]))) / travel, float(np.ptp(stay)) / travel
        if onward > STAYS or whole > HALF:
            most = max(most, whole)
    return most


def stays(x: Array) -> list[tuple[int, int]]:
    """Return, for each long stretch of a signal (n,) at one reading, its first sample and the first one after it."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(x) != 0.0) + 1, [len(x)]])
    long = np.flatnonzero(np.diff(edges) >= LONGEST)
    return [(int(edges[i]), int(edges[i + 1])) for i in long]


def without_wrong(run: AxesRun, axis: Axis) -> AxesRun:
    """Return the run without the wrong signals of an axis."""
    return run.without(axis.name, wrong_readings(run, axis).keys())


def _sentence(run: AxesRun, axis: Axis, signal: str, what: str, so: str) -> str:
    return f"{run.name}: {axis.name}.{signal} {what}; {so}"
