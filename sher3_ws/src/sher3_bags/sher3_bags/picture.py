"""One picture of a run: tip path, force against velocity, tracking, arrival times, drops."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from sher3_description import ACTUATORS

from sher3_bags.analysis import Analysis, force_and_velocity, tracking_error
from sher3_bags.run import Run

_MAX_POINTS = 5000
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9")


def draw(run: Run, analysis: Analysis, path: str | Path) -> Path:
    """Write the picture of a run as PNG (or what the suffix says); return its path."""
    figure = Figure(figsize=(14, 8), layout="constrained")
    FigureCanvasAgg(figure)
    name = run.path.name if run.path else "run"
    figure.suptitle(f"{name}: {analysis.duration:.2f} s, {analysis.dropped} samples dropped", fontsize=13)
    axes = figure.subplots(2, 3)
    with mpl.rc_context({"font.size": 9}):
        labels = "error [um, 1e-6 rad]", "error [um/s, 1e-6 rad/s]"
        _tip_path(axes[0, 0], run)
        _force_velocity(axes[0, 1], run, analysis)
        _tracking(axes[0, 2], run, "setpoint_js", "measured_js", "position", labels[0])
        _tracking(axes[1, 2], run, "drives/setpoint_jv", "drives/measured_js", "velocity", labels[1])
        _times(axes[1, 0], analysis)
        _drops(axes[1, 1], analysis)
    target = Path(path)
    figure.savefig(target, dpi=110)
    return target


def _absent(axis: Any, title: str, why: str) -> None:
    axis.set_title(title)
    axis.text(0.5, 0.5, why, ha="center", va="center", transform=axis.transAxes, color="0.5")
    axis.set_xticks([])
    axis.set_yticks([])


def _thin(n: int) -> slice:
    return slice(None, None, max(1, n // _MAX_POINTS))


def _tip_path(axis: Any, run: Run) -> None:
    if "measured_cp" not in run:
        return _absent(axis, "tip path", "no measured_cp")
    position = (run["measured_cp"].position - run["measured_cp"].position[0]) * 1e3
    thin = position[_thin(len(position))]
    for column, label, colour in ((1, "x-y", _COLOURS[0]), (2, "x-z", _COLOURS[1])):
        axis.plot(thin[:, 0], thin[:, column], lw=0.9, color=colour, label=label)
    axis.plot(0, 0, "ko", ms=4)
    axis.set_title("tip path from its start, {b}")
    axis.set_xlabel("x [mm]")
    axis.set_ylabel("y, z [mm]")
    axis.set_aspect("equal", adjustable="datalim")
    axis.legend(loc="best", frameon=False)
    return None


def _force_velocity(axis: Any, run: Run, analysis: Analysis) -> None:
    pair, fit = force_and_velocity(run), analysis.force_velocity
    if pair is None or fit is None:
        return _absent(axis, "force against velocity", "pedal never pressed")
    force, velocity = pair
    thin = _thin(len(force))
    for k, name in enumerate("xyz"):
        axis.plot(force[thin, k], velocity[thin, k] * 1e3, ".", ms=2, color=_COLOURS[k], label=name)
    axis.set_title(f"force against velocity: {1e3 * fit.gain:.3g} (mm/s)/N, r = {fit.correlation:.2f}")
    axis.set_xlabel("force on the tool, tared [N, in {b}]")
    axis.set_ylabel("tip velocity [mm/s]")
    axis.legend(loc="best", frameon=False, markerscale=4)
    return None


def _tracking(axis: Any, run: Run, wanted: str, measured: str, column: str, label: str) -> None:
    stamp, error = tracking_error(run, wanted, measured, column)
    if not len(stamp):
        return _absent(axis, f"{column} tracking", f"no {wanted} or {measured}")
    thin = _thin(len(stamp))
    seconds = (stamp - run.start) * 1e-9
    for k, name in enumerate(ACTUATORS):
        axis.plot(seconds[thin], error[thin, k] * 1e6, lw=0.7, color=_COLOURS[k], label=name)
    axis.set_yscale("symlog", linthresh=max(1.0, float(np.percentile(np.abs(error[:, :3]), 90)) * 1e6))
    axis.set_title(f"{column} tracking: {wanted} - {measured}")
    axis.set_xlabel("time [s]")
    axis.set_ylabel(label)
    axis.legend(loc="upper right", frameon=False, ncols=2, fontsize=8)
    return None


def _times(axis: Any, analysis: Analysis) -> None:
    timed = {t: x for t, x in analysis.topics.items() if x.latency is not None}
    if not timed:
        return _absent(axis, "latency", "logged at the stamps: no arrival times")
    for k, timing in enumerate(timed.values()):
        assert timing.latency is not None
        low, high = timing.latency.p50 * 1e3, timing.latency.p99 * 1e3
        axis.plot([low, high], [k, k], "-", lw=4, color=_COLOURS[0])
        axis.plot(timing.latency.max * 1e3, k, "|", ms=10, color=_COLOURS[1])
    axis.set_yticks(range(len(timed)), [f"{t} ({x.node})" if x.node else t for t, x in timed.items()], fontsize=8)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlabel("from stamp to arrival [ms]: median to 99 %, tick at the maximum")
    axis.set_title("latency by topic (node)")
    return None


def _drops(axis: Any, analysis: Analysis) -> None:
    timed = {topic: (x, x.period) for topic, x in analysis.topics.items() if x.period is not None and x.period.p50 > 0}
    if not timed:
        return _absent(axis, "period", "no samples")
    names = list(timed)
    axis.barh(range(len(names)), [p.max * 1e3 for _, p in timed.values()], color="0.85", label="longest")
    axis.barh(range(len(names)), [p.p50 * 1e3 for _, p in timed.values()], color=_COLOURS[2], label="median")
    for k, (timing, _) in enumerate(timed.values()):
        axis.text(1.0, k, f" {timing.dropped}", va="center", fontsize=8, transform=axis.get_yaxis_transform())
    axis.set_yticks(range(len(names)), names, fontsize=8)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlabel("time between samples [ms]")
    axis.set_title("period by topic; on the right, samples dropped")
    axis.legend(loc="lower right", frameon=False)
    return None
