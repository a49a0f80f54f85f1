"""Real against nominal against corrected, with residuals, of the channels with the largest gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.localise.gaps import PARTS
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.report.drawing import CORRECTED, NOMINAL, REAL, Line, Panel, picture
from sher3_diagnosis.reporter import Reporter, Trace
from sher3_diagnosis.words import place, words

WORST = 3
"""Channels shown of each part of the machine."""
COMPONENTS = ("x", "y", "z", "about x", "about y", "about z")
SCALES = ((1.0, ""), (1e3, "m"), (1e6, "µ"), (1e9, "n"))
LEAST = 0.5
"""Largest value on an axis of a picture below which the next prefix is taken."""
SEEN = 1e-3
"""Difference of two curves, in floors, below which they are one: whitening and back rounds."""
HOLE = 2.5
"""Sample steps without a sample at which a line breaks."""


@dataclass(frozen=True)
class _Lines:
    """What is drawn over `time` (n,).

    Attributes:
        real, nominal, corrected: output of the stage, (n,).
        floor: standard deviation of the residual's floor.
        name, unit: of the output.
    """

    time: Array
    real: Array
    nominal: Array
    corrected: Array
    floor: float
    name: str
    unit: str

    @property
    def changed(self) -> bool:
        """Whether a cause acts on what is drawn."""
        return bool(np.any(np.abs(self.nominal - self.corrected) > SEEN * self.floor))


def traces(diagnosis: Diagnosis, reporter: Reporter) -> list[Trace]:
    """Return the pictures: the machine's own first ones, the worst channels, the machine's own last ones."""
    first, last = reporter.own_traces(diagnosis)
    worst = [(f, g.channel) for f in diagnosis.findings for g in [g for g in f.gaps if g.significant][:WORST]]
    if not worst and not first:
        largest = [(f, f.gaps[0]) for f in diagnosis.findings if f.gaps]
        worst = [(f, g.channel) for f, g in sorted(largest, key=lambda x: -x[1].power)[:1]]
    made = [_channel(f, c, reporter) for f, c in worst]
    return [*first, *(t for t in made if t is not None), *last]


def _channel(finding: Finding, channel: Channel, reporter: Reporter) -> Trace | None:
    """Return the picture of a channel in the run with its largest gap; None where no run has it."""
    named = _acted_on(finding, channel)
    finding = finding if named else finding.with_all
    evidence = finding.evidence
    after = residual_after(evidence, finding.attribution.fit, channel)
    if not after:
        return None
    run = max(after, key=lambda r: _power(evidence, r, channel))
    found = evidence.data.residuals[run][channel]
    best = _component(found.values[found.ok], evidence.floors[run][channel])
    shown = [r for r in reporter.together(evidence, run) if r in after]
    lines = _lines(evidence, reporter, channel, shown, best, after, _acted_on(finding, channel))
    title = f"{words(channel.stage)}, {place(channel.actuator)}"
    if found.values.shape[1] > 1:
        title += f", {COMPONENTS[best]}"
    caption = reporter.run_name(evidence, run)
    bet = "" if named else " (the best bet, which is not sure enough to be named)"
    caption += f", held out: the correction{bet} was fitted to the other {reporter.held_out}." if lines.changed else ""
    if not lines.changed:
        caption += f": real and nominal model alone, {_why_uncorrected(finding, channel)}."
    return Trace(title, caption, _draw(lines, title, reporter.abscissa, "with the causes" if named else "best bet"))


def _acted_on(finding: Finding, channel: Channel) -> bool:
    """Return whether a cause shows on a channel."""
    found = finding.attribution
    return any(channel in found.fit.terms[i].channels for i in found.causes)


def _why_uncorrected(finding: Finding, channel: Channel) -> str:
    """Return why no corrected curve is drawn."""
    if channel not in finding.significant:
        return "since they differ by no more than repeats do"
    return "since no effect of the library explains what is left here"


def _lines(
    evidence: Evidence,
    reporter: Reporter,
    channel: Channel,
    runs: Sequence[int],
    best: int,
    after: dict[int, Array],
    acted_on: bool,
) -> _Lines:
    """Collect the lines of one component over the samples that count of these runs, in the order of time.

    What a fit without a cause changes are deviations within tolerance: no correction, and none is drawn.
    """
    parts = []
    name = ""
    for run in runs:
        found = evidence.data.residuals[run][channel]
        clock = reporter.clock(evidence, run)
        if clock is None:
            clock = np.arange(len(found.values)) / (evidence.views[run].rate or 1.0)
        put_out = reporter.output(evidence, run, channel)
        name = put_out.name
        before = found.values[found.ok][:, best]
        real = before if put_out.values is None else put_out.values[found.ok]
        left = after[run][:, best] if acted_on else before
        parts.append(np.stack([clock[found.ok], real, real - before, real - left]))
    together = np.concatenate(parts, axis=1)
    time, real, nominal, corrected = together[:, np.argsort(together[0], kind="stable")]
    floor = float(evidence.floors[runs[0]][channel][best])
    return _Lines(time, real, nominal, corrected, floor, name, _unit(evidence, channel, best))


def _unit(evidence: Evidence, channel: Channel, component: int) -> str:
    return evidence.unit(channel, component).replace("*", "·")


def _power(evidence: Evidence, run: int, channel: Channel) -> float:
    found = evidence.data.residuals[run][channel]
    return float(np.mean((found.values[found.ok] / evidence.floors[run][channel]) ** 2))


def _component(values: Array, floor: Array) -> int:
    """Component with the largest gap over floor, of the part that counts."""
    power = np.mean((values / floor) ** 2, axis=0)
    best = max(PARTS[len(floor)], key=lambda p: float(np.mean(power[p])))
    return int(best.start + np.argmax(power[best]))


def _draw(lines: _Lines, title: str, abscissa: str, corrected: str) -> str:
    scale, prefix = scale_of(lines.real)
    shown = [(lines.real, REAL, "real"), (lines.nominal, NOMINAL, "nominal model")]
    shown += [(lines.corrected, CORRECTED, corrected)] if lines.changed else []
    output = [_line(lines.time, scale * y, colour, label) for y, colour, label in shown]
    finer, small = scale_of(lines.real - lines.nominal)
    shown = [(lines.nominal, NOMINAL, "nominal residual")]
    shown += [(lines.corrected, CORRECTED, "residual left")] if lines.changed else []
    residual = [_line(lines.time, finer * (lines.real - y), colour, label) for y, colour, label in shown]
    panels = [
        Panel(f"{lines.name} [{prefix}{lines.unit}]", 138, output),
        Panel(f"residual [{small}{lines.unit}]", 92, residual, band=(2 * finer * lines.floor, "± 2 floor")),
    ]
    return picture(panels, abscissa, title)


def _line(time: Array, y: Array, colour: str, label: str) -> Line:
    """Return a line that breaks where samples are missing."""
    steps = np.diff(time)
    holes = np.flatnonzero(steps > HOLE * np.median(steps)) + 1 if len(steps) else np.array([], dtype=int)
    return Line(np.insert(time, holes, np.nan), np.insert(y, holes, np.nan), colour, label)


def scale_of(y: Array) -> tuple[float, str]:
    """Return the factor and the SI prefix with which values (n,) are drawn: the largest is at least `LEAST` then."""
    size = float(np.nanmax(np.abs(y))) if len(y) else 1.0
    return next(((s, p) for s, p in SCALES if size * s >= LEAST), SCALES[-1])
