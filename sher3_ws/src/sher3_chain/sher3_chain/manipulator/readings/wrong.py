"""Readings of an arm that are wrong in themselves: dead, flat at a level, or in another scale. They are named.

A second encoder that says nothing is left out, so that the links move as the motors say. Where an effort
lies flat at its largest reading its joint is not judged.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import Joint, ManipulatorDescription
from sher3_chain.readings.level import at_a_level, level_note, off, off_note
from sher3_chain.readings.wrong import wrong_readings


def level_notes(run: AxesRun, joints: Sequence[Joint], judged: Collection[str]) -> list[str]:
    """Return a sentence for each effort of a judged joint that lies flat at a level, or whose drive is off."""
    out = []
    for joint in joints:
        effort = run.signals[joint.name].get("effort") if joint.name in judged else None
        if effort is not None:
            for at, note in ((at_a_level(effort), level_note), (off(effort), off_note)):
                out += [note(f"{run.name}: {joint.name}.effort", at)] if at.any() else []
    return out


def without_wrong_loads(run: AxesRun, described: ManipulatorDescription) -> AxesRun:
    """Return the run without the second encoders that say nothing; efforts stay, their joints are not judged."""
    for joint in described.joints:
        run = run.without(joint.name, {"load"} & wrong_readings(run, joint).keys())
    return run
