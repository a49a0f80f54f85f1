"""What happened in a run, over time: force, speed of the tip, pedal and operating state under one another."""

from __future__ import annotations

from typing import Any

import numpy as np

from sher3_bags.figures.analysis import force_in_base, tip_velocity
from sher3_bags.run import Run

FORCE, SPEED, PEDAL = "#0072b2", "#d55e00", "#b7d7ea"
STATES = {"ENABLED": "#009e73", "DISABLED": "#9aa0a6", "PAUSED": "#e69f00", "FAULT": "#c1272d"}
MAX_POINTS = 5000


def draw_timeline(axis: Any, run: Run) -> None:
    """Draw force [N] and speed [mm/s] over the run's own time [s]; the pedal as an area, the state as a strip."""
    axis.set_title("force and speed; blue area: pedal pressed; strip: operating state; dotted: steps of the script")
    axis.set_xlabel("time [s]")
    axis.set_xlim(0.0, max((run.end - run.start) * 1e-9, 1e-3))
    _pedal(axis, run)
    _state(axis, run)
    _steps(axis, run)
    if all(topic in run for topic in ("force/measured_cf", "measured_cp", "pedal/measured")):
        stamp, force, _ = force_in_base(run)
        _line(axis, run, stamp, np.linalg.norm(force, axis=1), FORCE)
    axis.set_ylabel("force, tared [N]", color=FORCE)
    axis.set_ylim(bottom=0.0)
    if "measured_cp" in run and len(run["measured_cp"]) > 1:
        speed = axis.twinx()
        _line(speed, run, run["measured_cp"].stamp, np.linalg.norm(tip_velocity(run), axis=1) * 1e3, SPEED)
        speed.set_ylabel("speed of the tip [mm/s]", color=SPEED)
        speed.set_ylim(bottom=0.0)


def _line(axis: Any, run: Run, stamp: Any, values: Any, colour: str) -> None:
    thin = slice(None, None, max(1, len(stamp) // MAX_POINTS))
    axis.plot((stamp[thin] - run.start) * 1e-9, values[thin], lw=0.8, color=colour)


def _pedal(axis: Any, run: Run) -> None:
    if "pedal/measured" not in run or not len(run["pedal/measured"]):
        return
    pedal = run["pedal/measured"]
    pressed = np.r_[False, pedal.axes[:, 0] > 0.0, False]
    edges = np.flatnonzero(np.diff(pressed.astype(int)))
    seconds = (pedal.stamp - run.start) * 1e-9
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        axis.axvspan(seconds[begin], seconds[min(end, len(seconds) - 1)], color=PEDAL, alpha=0.5, lw=0)


def _steps(axis: Any, run: Run) -> None:
    """Draw where each step of the surgeon's script begins, with its name."""
    if "mock/step" not in run or not len(run["mock/step"]):
        return
    steps = run["mock/step"]
    log = steps.stamp if steps.log_time is None else steps.log_time
    for begin, name in zip((log - run.start) * 1e-9, steps.data or (), strict=True):
        axis.axvline(begin, lw=0.6, ls=":", color="#555555")
        where = axis.get_xaxis_transform()
        style = {"rotation": 90, "ha": "left", "va": "bottom", "fontsize": 7, "color": "#333333", "zorder": 5}
        paper = {"facecolor": "white", "alpha": 0.75, "lw": 0, "pad": 0.8}
        axis.text(begin, 0.03, f" {name}", transform=where, bbox=paper, **style)


def _state(axis: Any, run: Run) -> None:
    if "operating_state" not in run or not len(run["operating_state"]):
        return
    states = run["operating_state"]
    log = states.stamp if states.log_time is None else states.log_time
    names = [text.split()[0] if text else "" for text in states.data or ()]
    changes = [k for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    begins = np.clip((log[changes] - run.start) * 1e-9, 0.0, None)
    ends = np.r_[begins[1:], (run.end - run.start) * 1e-9]
    for name, begin, end in zip((names[k] for k in changes), begins, ends, strict=True):
        axis.axvspan(begin, end, ymin=0.97, color=STATES.get(name, "#555555"), lw=0)
        if end - begin > 0.08 * max(ends[-1], 1e-9):
            axis.text((begin + end) / 2, 0.95, name, transform=axis.get_xaxis_transform(), ha="center", va="top")
