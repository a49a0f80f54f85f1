"""Real against nominal against corrected, with residuals, of the channels with the largest gaps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from sher3_description import ACTUATORS

from sher3_gap.channels import Array, Channel, unit_of
from sher3_gap.diagnose import Diagnosis
from sher3_gap.exact import delayed
from sher3_gap.localise import PARTS, Gap
from sher3_gap.quantify import residual_after
from sher3_gap.report.style import CORRECTED, FLOOR, NOMINAL, REAL, STAGE_NAMES, figure, place, to_svg
from sher3_gap.residuals import mean_force
from sher3_gap.signals import RunSignals
from sher3_gap.timing import demand_in_force

WORST = 3
"""Channels shown."""
ABOVE: dict[str, Any] = {
    "loc": "lower right",
    "bbox_to_anchor": (1.0, 0.99),
    "ncols": 3,
    "fontsize": 8,
    "borderpad": 0.1,
}
"""A legend above its axes, where it hides no line."""
COMPONENTS = ("x", "y", "z", "about x", "about y", "about z")
SCALES = ((1.0, ""), (1e3, "m"), (1e6, "µ"), (1e9, "n"))


@dataclass(frozen=True)
class Trace:
    """One picture with its caption."""

    title: str
    caption: str
    svg: str


@dataclass(frozen=True)
class _Lines:
    """What is drawn: time (n,), then real, nominal and corrected output (n,), and the floor of the residual."""

    time: Array
    real: Array
    nominal: Array
    corrected: Array
    floor: float
    what: str

    @property
    def changed(self) -> bool:
        """Whether a cause acts on what is drawn."""
        return not np.array_equal(self.nominal, self.corrected)


def traces(diagnosis: Diagnosis) -> list[Trace]:
    """Return the pictures: the exact stage that failed, then the worst measured channels."""
    made = [_timing(diagnosis)] if any(f.where.stage == "transport" for f in diagnosis.exact) else []
    worst = [g for g in diagnosis.gaps if g.significant][:WORST]
    if not worst and not made:
        worst = diagnosis.gaps[:1]
    return [t for t in [*made, *(_channel(diagnosis, g) for g in worst)] if t is not None]


def _channel(diagnosis: Diagnosis, gap: Gap) -> Trace | None:
    evidence, channel = diagnosis.evidence, gap.channel
    after = residual_after(evidence, diagnosis.attribution.fit, channel)
    if not after:
        return None
    run = max(after, key=lambda r: _power(diagnosis, r, channel))
    found = evidence.data.residuals[run][channel]
    floor = evidence.floors[run][channel]
    best = _component(found.values[found.ok], floor)
    base, what = _output(diagnosis, evidence.runs[run], channel)
    signals = evidence.runs[run]
    real = (found.values if base is None else base)[found.ok][:, 0 if base is not None else best]
    before = found.values[found.ok][:, best]
    time = signals.stage_clock[signals.grid][found.ok]
    lines = _Lines(time, real, real - before, real - after[run][:, best], float(floor[best]), what)
    title = f"{STAGE_NAMES[channel.stage]}, {place(channel.actuator)}"
    if len(floor) > 1:
        title += f", {COMPONENTS[best]}"
    unit = unit_of(channel) if best < 3 else {"m": "rad", "N": "N*m"}[unit_of(channel)]
    caption = f"Run {signals.name} ({signals.excitation}, repeat {signals.repeat})"
    caption += ", held out: the correction was fitted to the other runs." if lines.changed else "; no cause acts here."
    return Trace(title, caption, _draw(lines, unit, title))


def _power(diagnosis: Diagnosis, run: int, channel: Channel) -> float:
    found = diagnosis.evidence.data.residuals[run][channel]
    return float(np.mean((found.values[found.ok] / diagnosis.evidence.floors[run][channel]) ** 2))


def _component(values: Array, floor: Array) -> int:
    """Component with the largest gap over floor, of the part that counts."""
    part = PARTS[len(floor)]
    power = np.mean((values / floor) ** 2, axis=0)
    best = max(part, key=lambda p: float(np.mean(power[p])))
    return int(best.start + np.argmax(power[best]))


def _output(diagnosis: Diagnosis, run: RunSignals, channel: Channel) -> tuple[Array | None, str]:
    """Measured output of a stage on the residual grid; None where the deviation itself is the picture."""
    axis = ACTUATORS.index(channel.actuator) if channel.actuator in ACTUATORS else 0
    if channel.stage == "motor_mechanics" and run.effort is not None:
        demand = demand_in_force(run, diagnosis.evidence.robot, diagnosis.evidence.timing)
        return run.to_grid(mean_force(run, diagnosis.evidence.robot, demand)[:, [axis]]), "motor force"
    if channel.stage == "drive" and run.effort is not None:
        return run.to_grid(run.effort[:, [axis]]), "reported effort"
    names = {"transmission": "load − motor", "mechanism": "tip − nominal tip", "structure": "tip − nominal tip"}
    return None, names.get(channel.stage, "reading − nominal")


def _draw(lines: _Lines, unit: str, title: str) -> str:
    made, (top, bottom) = figure(2, 4.1, sharex=True, height_ratios=[1.5, 1.0])
    scale, prefix = _scale(lines.real)
    for y, color, label, width in (
        (lines.real, REAL, "real", 1.3),
        (lines.nominal, NOMINAL, "nominal model", 1.1),
        (lines.corrected, CORRECTED, "with the causes", 1.1),
    ):
        if lines.changed or color != CORRECTED:
            _line(top, lines.time, scale * y, color, label, width)
    top.set_ylabel(f"{lines.what} [{prefix}{unit.replace('*', '·')}]")
    top.legend(**ABOVE)
    before, left = lines.real - lines.nominal, lines.real - lines.corrected
    scale, prefix = _scale(before)
    bottom.axhspan(-2 * scale * lines.floor, 2 * scale * lines.floor, color=FLOOR, alpha=0.25, lw=0, label="± 2 floor")
    _line(bottom, lines.time, scale * before, NOMINAL, "nominal residual", 0.9)
    if lines.changed:
        _line(bottom, lines.time, scale * left, CORRECTED, "residual left", 0.9)
    bottom.set_ylabel(f"residual [{prefix}{unit.replace('*', '·')}]")
    bottom.set_xlabel("time [s]")
    bottom.legend(**ABOVE)
    top.margins(x=0.005, y=0.06)
    bottom.margins(x=0.005, y=0.06)
    return to_svg(made, title)


def _line(ax: Axes, time: Array, y: Array, color: str, label: str, width: float) -> None:
    """Draw a line that breaks where samples are missing."""
    step = np.median(np.diff(time)) if len(time) > 1 else 1.0
    broken = np.insert(y, np.flatnonzero(np.diff(time) > 2.5 * step) + 1, np.nan)
    clock = np.insert(time, np.flatnonzero(np.diff(time) > 2.5 * step) + 1, np.nan)
    ax.plot(clock, broken, color=color, lw=width, label=label)


def _scale(y: Array) -> tuple[float, str]:
    size = float(np.nanmax(np.abs(y))) if len(y) else 1.0
    return next(((s, p) for s, p in SCALES if size * s >= 0.5), SCALES[-1])


def _timing(diagnosis: Diagnosis) -> Trace | None:
    """Commands and the drives' echo around the steepest change of a command."""
    timing = diagnosis.evidence.timing
    if timing is None:
        return None
    run, axis, at = _steepest(diagnosis)
    assert run.command is not None and run.echo is not None
    low, high = max(0, at - 12), min(run.ticks, at + 22)
    clock = 1e3 * (run.stage_clock[low:high] - run.stage_clock[at])
    unit = "rad/s" if ACTUATORS[axis] == "roll" else "m/s"
    nominal = delayed(run.command, 1)[low:high, axis]
    scale, prefix = _scale(nominal)
    made, (ax,) = figure(1, 2.6)
    ax.step(clock, scale * run.echo[low:high, axis], where="pre", color=REAL, lw=1.5, label="demand executed (echo)")
    ax.step(clock, scale * nominal, where="pre", color=NOMINAL, lw=1.2, label="nominal: command on time")
    ax.set_xlabel("time [ms]")
    ax.set_ylabel(f"velocity demand [{prefix}{unit}]")
    ax.legend(loc="best", fontsize=8)
    title = f"Transport, {place(ACTUATORS[axis])}"
    return Trace(title, f"Run {run.name} around its steepest command.", to_svg(made, title))


def _steepest(diagnosis: Diagnosis) -> tuple[RunSignals, int, int]:
    top = np.array([a.limits.velocity for a in diagnosis.evidence.robot.actuators])
    best: tuple[float, RunSignals, int, int] | None = None
    for run in diagnosis.evidence.runs:
        if run.command is None or run.echo is None:
            continue
        steps = np.abs(np.diff(run.echo - delayed(run.command, 1), axis=0)) / top
        at, axis = np.unravel_index(int(np.argmax(steps)), steps.shape)
        if best is None or steps[at, axis] > best[0]:
            best = (float(steps[at, axis]), run, int(axis), int(at))
    assert best is not None
    return best[1:]
