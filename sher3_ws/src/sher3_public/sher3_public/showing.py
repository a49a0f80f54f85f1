"""A diagnosis as a person sees it: a figure, and the HTML of a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.report.traces import traces
from sher3_diagnosis.words import place, words

STYLE: dict[Any, Any] = {"font.size": 9, "axes.grid": True, "grid.color": "#e5e7eb", "legend.frameon": False}
"""Settings of Matplotlib in force while a figure is made."""
MOST = 4
"""Places that a figure shows at most."""
PAPER = "background:#fff;color:#1f2937;padding:4px 12px;border-radius:8px;max-width:900px"
"""Style of an answer in a notebook: pictures are drawn for a light ground, which a dark notebook has not."""
WIDE, HIGH = 8.0, 2.0
"""Width of a figure and height of one picture of it, inch."""


def figure_of(diagnosis: Diagnosis[Any]) -> Figure:
    """Return the unexplained force or motion at the largest gaps, before and after the causes, over the floor."""
    shown = [(f, g.channel) for f in diagnosis.findings for g in f.gaps if g.significant][:MOST]
    shown = shown or [(f, f.gaps[0].channel) for f in diagnosis.findings if f.gaps][:1]
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDE, HIGH * max(1, len(shown))), layout="constrained")
        rows = figure.subplots(max(1, len(shown)), 1, squeeze=False)[:, 0]
        for axes, (finding, channel) in zip(rows, shown, strict=False):
            _draw(axes, finding, channel, diagnosis.machine.reporter())
        if shown:
            rows[0].legend(loc="upper right", fontsize="small")
            rows[-1].set_xlabel("time, s; records one behind the other")
    return figure


def _draw(axes: Any, finding: Finding[Any], channel: Channel, reporter: Any) -> None:
    evidence = finding.evidence
    after = residual_after(evidence, finding.attribution.fit, channel)
    before = residual_after(evidence, evidence.null(), channel)
    start = ended = 0.0
    for number, run in enumerate(sorted(after)):
        x = [np.asarray(found[run]).reshape(len(found[run]), -1)[:, 0] for found in (before, after)]
        clock = _clock(evidence, run, channel, reporter, len(x[0]))
        start += ended if clock[0] < ended else 0.0  # a part of the same record goes on, another record starts anew
        for y, colour, label in ((x[0], "0.65", "model alone"), (x[1], "C0", "with the causes")):
            axes.plot(start + clock, y, color=colour, lw=0.8, label=None if number else label)
        ended = float(clock[-1])
    axes.set_title(f"{words(channel.stage)}, {place(channel.actuator)}", fontsize="small", loc="left")
    axes.set_ylabel(evidence.units[channel].replace("*", "·") if isinstance(evidence.units, dict) else "")


def _clock(evidence: Any, run: int, channel: Channel, reporter: Any, samples: int) -> Any:
    """Seconds of the samples that count; their numbers where they are not known."""
    found, clock = evidence.data.residuals[run][channel], reporter.clock(evidence, run)
    if clock is None:
        clock = np.arange(len(found.values)) / (evidence.views[run].rate or 1.0)
    kept = np.asarray(clock)[found.ok]
    return kept if len(kept) == samples else np.arange(samples)


def html_of(
    diagnosis: Diagnosis[Any], headline: str, lists: Mapping[str, Sequence[str]], folded: Mapping[str, Sequence[str]]
) -> str:
    """Return a diagnosis as HTML: headline, lists under their titles, the first picture, and lists that are folded."""
    drawn = traces(diagnosis, diagnosis.machine.reporter())[:1]
    shown = [f"<p>{escape(title)}</p>{_items(texts)}" for title, texts in lists.items() if texts]
    shown += [f"<figure>{trace.svg}</figure>" for trace in drawn]
    shown += [
        f"<details><summary>{escape(title)} ({len(texts)})</summary>{_items(texts)}</details>"
        for title, texts in folded.items()
        if texts
    ]
    return f'<div style="{PAPER}"><p><b>{escape(headline)}</b></p>{"".join(shown)}</div>'


def _items(texts: Sequence[str]) -> str:
    return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"
