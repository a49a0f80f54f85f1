"""Analysis and comparison as text."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from sher3_bags.figures.analysis import Analysis
from sher3_bags.figures.compare import Comparison
from sher3_bags.figures.statistics import Spread
from sher3_bags.figures.tracking import AxisError

SMALLEST = 1e-15
"""Magnitude below which a difference is rounding and shown as 0: a thousandth of a picometre."""
TIMES = "times are median/99 %/max; missing: ticks without a sample, which the node lost (below) or the way to the bag"
_PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def quantity(value: float | None, unit: str) -> str:
    """Return a number with three digits and an SI prefix, `-` for None."""
    if value is None:
        return "-"
    if abs(value) < SMALLEST:
        return f"0 {unit}".rstrip()
    if not unit:
        return f"{value:.3g}"
    for scale, prefix in _PREFIXES:
        if abs(value) >= scale:
            return f"{value / scale:.3g} {prefix}{unit}"
    return f"{value / 1e-9:.2g} n{unit}"


def table(header: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return columns aligned with spaces; the first column to the left."""
    lines = [[str(cell) for cell in row] for row in (header, *rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(line, widths, strict=True))
        )
        for line in lines
    )


def _spread(spread: Spread | None) -> str:
    if spread is None:
        return "-"
    times = [1e3 * value for value in (spread.p50, spread.p99, spread.max)]
    return "/".join(f"{value:.0f}" if abs(value) >= 999.5 else f"{value:.3g}" for value in times)


class Block(NamedTuple):
    """A part of a report: what it is about, and a table where there is one."""

    text: str
    header: tuple[str, ...] = ()
    rows: tuple[tuple[object, ...], ...] = ()

    def __str__(self) -> str:
        return f"{self.text}\n{table(self.header, self.rows)}" if self.rows else self.text


def analysis_text(analysis: Analysis) -> str:
    """Return the figures of a run, a screenful."""
    return "\n\n".join(map(str, analysis_blocks(analysis)))


def analysis_blocks(analysis: Analysis) -> list[Block]:
    """Return the figures of a run as sentences and tables."""
    count = sum(timing.messages for timing in analysis.topics.values())
    extent = f"{analysis.duration:.3f} s, {count} messages, {analysis.dropped} samples missing"
    blocks = [Block(f"{analysis.source}: {extent}")]
    blocks += _timing(analysis)
    blocks += _tracking("position tracking (setpoint_js - measured_js)", analysis.position_tracking)
    blocks += _tracking("drive tracking (integral of drives/setpoint_jv - motor position)", analysis.drive_tracking)
    blocks += _tracking("velocity tracking (drives/setpoint_jv - motor, 20 ms average)", analysis.velocity_tracking)
    if analysis.tip is not None:
        extent = " x ".join(f"{1e3 * value:.3g}" for value in analysis.tip.extent)
        speed = quantity(analysis.tip.max_speed, "m/s")
        blocks.append(
            Block(f"tip: path {quantity(analysis.tip.length, 'm')}, extent {extent} mm, largest speed {speed}")
        )
    if analysis.tracker_rms is not None:
        blocks.append(Block(f"tracker: {quantity(analysis.tracker_rms, 'm')} rms from measured_cp"))
    if analysis.force_velocity is not None:
        fit = analysis.force_velocity
        blocks.append(
            Block(
                f"force against velocity: {1e3 * fit.gain:.3g} (mm/s)/N, correlation {fit.correlation:.3f}, "
                f"largest force {fit.max_force:.3g} N, {fit.samples} samples with the pedal pressed"
            )
        )
        if fit.doubt:
            blocks.append(Block(f"do not trust that line: {fit.doubt}"))
    return blocks


def _timing(analysis: Analysis) -> list[Block]:
    header = ("topic", "node", "messages", "Hz", "period [ms]", "latency [ms]", "from force [ms]", "missing", "pauses")
    rows = tuple(
        (
            topic,
            timing.node or "-",
            timing.messages,
            f"{timing.rate:.1f}",
            _spread(timing.period),
            _spread(timing.latency),
            _spread(timing.from_force),
            timing.dropped,
            timing.pauses,
        )
        for topic, timing in analysis.topics.items()
    )
    bad = [f"{t}: {x.disordered} stamps out of order" for t, x in analysis.topics.items() if x.disordered]
    bad += [f"{t}: {x.not_finite} values not finite" for t, x in analysis.topics.items() if x.not_finite]
    return [Block(TIMES, header, rows), *map(Block, bad)]


def _tracking(title: str, errors: tuple[AxisError, ...]) -> list[Block]:
    rows = tuple(
        (e.actuator, quantity(e.mean, e.unit), quantity(e.rms, e.unit), quantity(e.max, e.unit)) for e in errors
    )
    return [Block(title, ("axis", "mean", "rms", "max"), rows)] if rows else []


def comparison_text(comparison: Comparison) -> str:
    """Return the residuals of two runs, one line per axis."""
    rows = [
        (
            f"{topic} {column} {axis.axis}" if len(axes) > 1 else f"{topic} {column}",
            quantity(axis.lag, "s"),
            "-" if axis.correlation is None else f"{axis.correlation:.4f}",
            *(quantity(value, axis.unit) for value in (axis.mean, axis.rms, axis.max, axis.rms_aligned)),
        )
        for topic, columns in comparison.residuals.items()
        for column, axes in columns.items()
        for axis in axes
    ]
    head = f"b: {comparison.b}\na: {comparison.a}\n"
    head += f"aligned by {comparison.alignment}, {comparison.overlap:.3f} s in common, "
    head += f"b is later by {quantity(comparison.lag, 's')} (median)"
    parts = [head, table(("b - a", "lag", "correlation", "mean", "rms", "max", "rms aligned"), rows)]
    for name, only in (("a", comparison.only_in_a), ("b", comparison.only_in_b)):
        if only:
            parts.append(f"only in {name}: {', '.join(only)}")
    return "\n\n".join(parts)
