"""One picture of a run: tip path, force against velocity, tracking, what happened over time, arrival times, drops."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sher3_bags.figures.analysis import Analysis, force_and_velocity
from sher3_bags.figures.report import quantity
from sher3_bags.figures.statistics import Spread
from sher3_bags.figures.timeline import draw_timeline
from sher3_bags.figures.tracking import AxisError, Error, drive_error, position_error, velocity_error
from sher3_bags.run import Run

_MAX_POINTS = 5000
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9")


def draw(run: Run, analysis: Analysis, path: str | Path) -> Path:
    """Write the picture of a run in the format of the path's suffix (PNG and others); return the path."""
    target = Path(path)
    _figure(run, analysis).savefig(target, dpi=110)
    return target


def png(run: Run, analysis: Analysis) -> bytes:
    """Return the picture of a run as PNG."""
    file = io.BytesIO()
    _figure(run, analysis).savefig(file, dpi=110, format="png")
    return file.getvalue()


def _figure(run: Run, analysis: Analysis) -> Figure:
    figure = Figure(figsize=(15, 11), layout="constrained")
    FigureCanvasAgg(figure)
    name = run.path.name if run.path else "run"
    title = f"{name}: {analysis.duration:.2f} s, {analysis.dropped} samples missing"
    figure.suptitle(title, fontsize=13, parse_math=False)
    grid = figure.add_gridspec(3, 3, height_ratios=(1.2, 0.8, 1.0))
    with mpl.rc_context({"font.size": 9}):
        _tip_path(figure.add_subplot(grid[0, 0], projection="3d"), run)
        _force_velocity(figure.add_subplot(grid[0, 1]), run, analysis)
        position = (analysis.position_tracking, position_error(run), "position error")
        drive = (analysis.drive_tracking, drive_error(run), "drive error")
        _tracking(figure.add_subplot(grid[0, 2]), run, *(position if analysis.position_tracking else drive))
        draw_timeline(figure.add_subplot(grid[1, :]), run)
        _times(figure.add_subplot(grid[2, 0]), analysis)
        _drops(figure.add_subplot(grid[2, 1]), analysis)
        velocity = (analysis.velocity_tracking, velocity_error(run), "velocity error")
        _tracking(figure.add_subplot(grid[2, 2]), run, *velocity)
    return figure


def _absent(axis: Any, title: str, why: str) -> None:
    axis.set_title(title)
    axis.text(0.5, 0.5, why, ha="center", va="center", transform=axis.transAxes, color="0.5")
    axis.set_xticks([])
    axis.set_yticks([])


def _thin(n: int) -> slice:
    return slice(None, None, max(1, n // _MAX_POINTS))


def _tip_path(axis: Any, run: Run) -> None:
    axis.set_title("tip path from its start, {b} [mm]")
    if "measured_cp" not in run:
        axis.text2D(0.5, 0.5, "no measured_cp", ha="center", transform=axis.transAxes, color="0.5")
        return
    position = (run["measured_cp"].position - run["measured_cp"].position[0]) * 1e3
    thin = position[_thin(len(position))]
    axis.plot(thin[:, 0], thin[:, 1], thin[:, 2], lw=0.9, color=_COLOURS[0])
    axis.plot([0], [0], [0], "ko", ms=4)
    reach = max(float(np.ptp(thin, axis=0).max()), 1e-3) / 2
    middle = (thin.max(axis=0) + thin.min(axis=0)) / 2
    for name, centre in zip("xyz", middle, strict=True):
        getattr(axis, f"set_{name}lim")(centre - reach, centre + reach)
        getattr(axis, f"set_{name}label")(name)
    axis.set_box_aspect((1, 1, 1))


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


def _tracking(axis: Any, run: Run, figures: tuple[AxisError, ...], error: Error | None, title: str) -> None:
    """Draw one trace per axis, each scaled by itself; the scale is written beside the name of the axis."""
    if error is None or not figures:
        return _absent(axis, title, "no set-point, or no measurement")
    thin = _thin(len(error.stamp))
    seconds = (error.stamp[thin] - run.start) * 1e-9
    for k, figure in enumerate(figures):
        axis.plot(seconds, 0.48 * error.values[thin, k] / max(figure.max, 1e-30) - k, lw=0.6, color=_COLOURS[k])
        axis.axhline(-k, lw=0.4, color="0.6")
    names = [f"{figure.actuator}\n±{quantity(figure.max, figure.unit)}" for figure in figures]
    axis.set_yticks([-k for k in range(len(figures))], names, fontsize=8)
    axis.set_title(f"{title}, own scales")
    axis.set_xlabel("time [s]")
    return None


def _times(axis: Any, analysis: Analysis) -> None:
    """Draw, by topic, the time from the stamp of a sample to its arrival."""
    timed = {f"{t} ({x.node})" if x.node else t: x.latency for t, x in analysis.topics.items() if x.latency is not None}
    if not timed:
        return _absent(axis, "latency", "logged at the stamps: no arrival times")
    _spreads(axis, timed)
    axis.set_xlim(left=0)
    axis.set_title("from stamp to arrival, by topic (node)")
    return None


def _drops(axis: Any, analysis: Analysis) -> None:
    """Draw the time between samples, by topic, with the number of missing ones."""
    timed = {
        f"{t}, {x.dropped} missing": x.period
        for t, x in analysis.topics.items()
        if x.off_grid is not None and x.period is not None and x.period.p50 > 0
    }
    if not timed:
        return _absent(axis, "period", "no samples")
    _spreads(axis, timed)
    axis.set_xscale("log")
    axis.set_title("time between samples, by topic")
    return None


def _spreads(axis: Any, spreads: dict[str, Spread]) -> None:
    """Draw a bar from median to 99th percentile and a tick at the maximum per row, in ms."""
    for k, spread in enumerate(spreads.values()):
        axis.plot([spread.p50 * 1e3, spread.p99 * 1e3], [k, k], "-", lw=4, color=_COLOURS[0], solid_capstyle="butt")
        axis.plot(spread.p50 * 1e3, k, "o", ms=5, color=_COLOURS[0])
        axis.plot(spread.max * 1e3, k, "|", ms=11, mew=2, color=_COLOURS[1])
    axis.set_yticks(range(len(spreads)), list(spreads), fontsize=8)
    axis.invert_yaxis()
    axis.set_xlabel("ms: dot median, bar to 99 %, tick maximum")
