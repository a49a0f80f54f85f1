"""What was recorded of a case: topics, runs, and which effects the topics can tell apart."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.reporter import counted

from sher3_gap.signals import RunSignals

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
EXACT_NEEDS = {"controller": ("command", "reference", "load"), "transport": ("command", "echo")}
"""Exact stage -> signals it is computed from."""


def recorded_topics(runs: Sequence[RunSignals]) -> set[str]:
    """Return the topics that at least one run has."""
    return {topic for name, topic in TOPIC_OF.items() if any(getattr(run, name) is not None for run in runs)}


def exact_stages(runs: Sequence[RunSignals]) -> dict[str, bool]:
    """Return, per exact stage, whether some run recorded what it is computed from."""
    return {
        stage: any(all(getattr(run, name) is not None for name in names) for run in runs)
        for stage, names in EXACT_NEEDS.items()
    }


def data_text(runs: Sequence[RunSignals]) -> str:
    """Return how many runs there are, how long, and of which excitations."""
    seconds = sum(r.ticks * r.period for r in runs)
    return f"{len(runs)} runs, {seconds:.0f} s: {counted([r.excitation for r in runs])}"
