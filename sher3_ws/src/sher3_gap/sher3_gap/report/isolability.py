"""What the recorded topics can tell apart at all, said before anything is fitted."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_gap.report.style import words
from sher3_gap.signals import RunSignals
from sher3_gap.structure import Structure, structure

TOPIC_OF = {
    "motor": "drives/measured_js",
    "reference": "setpoint_js",
    "command": "servo_jv",
    "echo": "drives/setpoint_jv",
    "load": "measured_js",
    "wrench": "force/measured_cf",
    "tracker_position": "tracker/measured_cp",
}
"""Signal of a run -> topic it comes from."""


def recorded_topics(runs: Sequence[RunSignals]) -> set[str]:
    """Return the topics that at least one run has."""
    return {topic for name, topic in TOPIC_OF.items() if any(getattr(run, name) is not None for run in runs)}


def structure_of(runs: Sequence[RunSignals]) -> Structure:
    """Return the structural analysis of what these runs recorded."""
    return structure(recorded_topics(runs))


def group_rows(found: Structure) -> list[list[str]]:
    """Return the groups in words, largest first."""
    return [sorted(words(e) for e in group) for group in found.groups]
