"""Readings of an arm that are wrong in themselves: dead, flat at a level, or in another scale. They are named.

A second encoder that says nothing is left out, so that the links move as the motors say. Where an effort
lies flat at its largest reading its joint is not judged.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.channel import Array, Mask

from sher3_machines.axes.health import dead_channels
from sher3_machines.axes.limits import longest
from sher3_machines.axes.record import AxesRun
from sher3_machines.manipulator.description import Joint, ManipulatorDescription
from sher3_machines.thresholds import LONGEST, PINNED, STAYS


def wrong_readings(run: AxesRun, joint: Joint) -> Mapping[str, str]:
    """Return the signals of a joint that are dead, flat or in another scale, each with a sentence that names it."""
    out, found = dict(dead_channels(run, joint)), run.signals[joint.name]
    if "load" in found and "load" not in out:
        share = stays_over(found["load"], found["position"])
        if share > STAYS:
            what = f"stays at one reading while the joint moves over {share:.0%} of its travel: flat"
            out["load"] = f"{run.name}: {joint.name}.load {what}; it is left out"
    return out


def stays_over(load: Array, position: Array) -> float:
    """Return the share of an axis' travel over which a second encoder stays at its most frequent reading, (n,) each."""
    values, where = np.unique(load, return_inverse=True)
    same = where == np.bincount(where, minlength=len(values)).argmax()
    return float(np.ptp(position[same])) / max(float(np.ptp(position)), np.finfo(float).tiny)


def at_a_level(effort: Array) -> Mask:
    """Return (n,) True where a reading lies at its largest or least value for a stretch: it or the drive is limited."""
    out = np.zeros(len(effort), dtype=bool)
    for level in (float(effort.max()), float(effort.min())):
        at = effort == level
        if at.mean() >= PINNED and longest(at) >= LONGEST and not at.all():
            out |= at
    return out


def level_notes(run: AxesRun, joints: Sequence[Joint], judged: Collection[str]) -> list[str]:
    """Return a sentence for each effort of a judged joint that lies flat at a level."""
    out = []
    for joint in joints:
        effort = run.signals[joint.name].get("effort") if joint.name in judged else None
        share = float(at_a_level(effort).mean()) if effort is not None else 0.0
        if share:
            out.append(
                f"{run.name}: {joint.name}.effort lies flat at its largest reading in {share:.0%} of the samples: its "
                "reading or the drive is at a limit; these samples are not judged"
            )
    return out


def without_wrong_loads(run: AxesRun, described: ManipulatorDescription) -> AxesRun:
    """Return the run without the second encoders that say nothing; efforts stay, their joints are not judged."""
    signals = dict(run.signals)
    for joint in described.joints:
        if "load" in wrong_readings(run, joint):
            signals[joint.name] = {k: x for k, x in signals[joint.name].items() if k != "load"}
    return replace(run, signals=signals)
