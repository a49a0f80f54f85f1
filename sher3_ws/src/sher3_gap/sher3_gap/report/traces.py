"""Pictures of the robot's own: the transport stage about its steepest command, and the tip from end to end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_description import ACTUATORS
from sher3_diagnosis.report.drawing import CORRECTED, NOMINAL, REAL, Line, Panel, picture, stepped
from sher3_diagnosis.report.traces import scale_of
from sher3_diagnosis.reporter import Trace
from sher3_diagnosis.verdict import Cause
from sher3_diagnosis.words import place
from sher3_effects import to_effects

from sher3_gap.evidence import SherEvidence
from sher3_gap.nominal_replay import driven_as
from sher3_gap.signals import RunSignals
from sher3_gap.simulate.tip import tip_error
from sher3_gap.stages.exact.law import delayed
from sher3_gap.stages.units import ROTARY_AXES


def free_run_trace(evidence: SherEvidence, causes: Sequence[Cause]) -> Trace | None:
    """Return the largest tip error: tracked, and simulated from the same set-points with and without the causes.

    None without tracker, set-points or causes.
    """
    pairs = zip(evidence.runs, evidence.twins, strict=True)
    tracked = [(r, twin) for r, twin in pairs if r.tracker_position is not None and r.reference is not None]
    if not tracked or not causes:
        return None
    nominal = {r.name: tip_error(r, twin) for r, twin in tracked}
    run = max((r for r, _ in tracked), key=lambda r: float(np.mean(nominal[r.name] ** 2)))
    corrected = tip_error(run, driven_as(run, evidence.robot, effects=to_effects(causes, evidence.robot)))
    assert run.tracker_index is not None
    clock = run.stage_clock[run.tracker_index][: len(corrected)]
    lines = []
    for error, colour, label in (
        (nominal[run.name], NOMINAL, "nominal model"),
        (corrected, CORRECTED, "with the causes"),
    ):
        distance = 1e6 * np.linalg.norm(error, axis=1)
        lines.append(Line(clock, distance, colour, f"{label}, {np.sqrt(np.mean(distance**2)):.1f} µm rms"))
    panel = Panel("distance from the real tip [µm]", 140, lines)
    caption = f"Run {run.name} ({run.excitation}): both models run freely from the recorded set-points."
    return Trace("Tip position, end to end", caption, picture([panel], "time [s]", "tip, free run"))


BEFORE, BEHIND = 12, 22
"""Ticks shown on either side of the change: a late demand follows it."""


class _Change(NamedTuple):
    """Where the echo leaves the command: run, axis and tick."""

    run: RunSignals
    axis: int
    tick: int


def transport_trace(evidence: SherEvidence) -> Trace | None:
    """Return commands and the drives' echo around the steepest change of a command; None without an echo."""
    found = _steepest(evidence)
    if found is None:
        return None
    run, axis, at = found
    assert run.command is not None and run.echo is not None
    low, high = max(0, at - BEFORE), min(run.ticks, at + BEHIND)
    clock = 1e3 * (run.stage_clock[low:high] - run.stage_clock[at])
    nominal = delayed(run.command, 1)[low:high, axis]
    scale, prefix = scale_of(nominal)
    lines = [
        stepped(clock, scale * run.echo[low:high, axis], REAL, "demand executed (echo)"),
        stepped(clock, scale * nominal, NOMINAL, "nominal: command on time"),
    ]
    unit = "rad/s" if ACTUATORS[axis] in ROTARY_AXES else "m/s"
    panel = Panel(f"velocity demand [{prefix}{unit}]", 140, lines)
    title = f"Transport, {place(ACTUATORS[axis])}"
    return Trace(title, f"Run {run.name} around its steepest command.", picture([panel], "time [ms]", title))


def _steepest(evidence: SherEvidence) -> _Change | None:
    """Return where the error of the echo changes most, over the velocity limit of its axis."""
    top = np.array([a.limits.velocity for a in evidence.robot.actuators])
    best, found = -1.0, None
    for run in evidence.runs:
        if run.command is None or run.echo is None:
            continue
        steps = np.abs(np.diff(run.echo - delayed(run.command, 1), axis=0)) / top
        at, axis = np.unravel_index(int(np.argmax(steps)), steps.shape)
        if steps[at, axis] > best:
            best, found = float(steps[at, axis]), _Change(run, int(axis), int(at))
    return found
