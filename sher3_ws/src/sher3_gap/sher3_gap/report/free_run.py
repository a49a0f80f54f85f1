"""The tip end to end: tracked, simulated from the same set-points by the nominal model, and with the causes added."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.report.drawing import ABOVE, CORRECTED, MARGINS, NOMINAL, figure, to_svg
from sher3_diagnosis.reporter import Trace
from sher3_diagnosis.verdict import Cause
from sher3_effects import to_effects

from sher3_gap.evidence import SherEvidence
from sher3_gap.nominal_replay import driven_as
from sher3_gap.simulate.tip import tip_error


def free_run_trace(evidence: SherEvidence, causes: Sequence[Cause]) -> Trace | None:
    """Return the picture of the run with the largest tip error; None without tracker, set-points or causes."""
    runs = [r for r in evidence.runs if r.tracker_position is not None and r.reference is not None]
    if not runs or not causes:
        return None
    nominal = {r.name: tip_error(r, driven_as(r, evidence.robot)) for r in runs}
    run = max(runs, key=lambda r: float(np.mean(nominal[r.name] ** 2)))
    corrected = tip_error(run, driven_as(run, evidence.robot, effects=to_effects(causes, evidence.robot)))
    assert run.tracker_index is not None
    clock = run.stage_clock[run.tracker_index][: len(corrected)]
    made, (ax,) = figure(1, 2.5)
    for error, color, label in (
        (nominal[run.name], NOMINAL, "nominal model"),
        (corrected, CORRECTED, "with the causes"),
    ):
        distance = 1e6 * np.linalg.norm(error, axis=1)
        ax.plot(clock, distance, color=color, lw=1.1, label=f"{label}, {np.sqrt(np.mean(distance**2)):.1f} µm rms")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("distance from the real tip [µm]")
    ax.legend(**ABOVE)
    ax.margins(**MARGINS)
    ax.set_ylim(bottom=0.0)
    caption = f"Run {run.name} ({run.excitation}): both models run freely from the recorded set-points."
    return Trace("Tip position, end to end", caption, to_svg(made, "tip, free run"))
