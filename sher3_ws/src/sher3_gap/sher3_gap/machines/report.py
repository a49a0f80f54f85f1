"""The report on a machine: the verdict in words and tables, closures, and each axis' residual before and after."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import jinja2
import numpy as np
from matplotlib import rc_context

from sher3_gap.evidence import Evidence
from sher3_gap.fitting import fit
from sher3_gap.machines.finding import AxisFinding, unit_of
from sher3_gap.quantify import residual_after
from sher3_gap.report.closures import closure_bars
from sher3_gap.report.style import (
    CORRECTED,
    FLOOR,
    NOMINAL,
    STAGE_NAMES,
    STYLE,
    figure,
    quantity,
    range_text,
    share,
    to_svg,
    words,
)
from sher3_gap.report.summary import five_lines, headline
from sher3_gap.verdict import Verdict


def render(verdict: Verdict, findings: Sequence[AxisFinding], title: str) -> str:
    """Return the report as one HTML page without external resources."""
    environment = jinja2.Environment(loader=jinja2.PackageLoader("sher3_gap", "machines"), autoescape=True)
    with rc_context(STYLE):
        return environment.get_template("report.html").render(
            title=title,
            verdict=verdict,
            headline=headline(verdict),
            lines=five_lines(verdict),
            stage_names=STAGE_NAMES,
            quantity=quantity,
            range_text=range_text,
            share=share,
            words=words,
            bars=closure_bars(verdict),
            traces=[t for f in findings for t in _traces(f)],
        )


def _traces(finding: AxisFinding) -> list[tuple[str, str]]:
    """Held-out residual of every channel with a gap, nominal and with the causes, blocks in a row."""
    evidence = cast(Evidence, finding.evidence)
    null, out = fit(evidence.data, []), []
    for channel, gap in finding.gaps.items():
        made, (ax,) = figure(1, 2.4)
        for after, color, label in (
            (null, NOMINAL, "nominal"),
            (finding.attribution.fit, CORRECTED, "with the causes"),
        ):
            values = np.concatenate([x[:, 0] for x in residual_after(evidence, after, channel).values()])
            ax.plot(values, color=color, lw=0.9, label=label)
        ax.axhspan(-gap.floor, gap.floor, color=FLOOR, alpha=0.4, lw=0)
        ax.set_ylabel(f"residual, {unit_of(finding.axis, channel.stage)}")
        ax.set_xlabel("samples that count, records in a row")
        ax.legend(loc="upper right", ncols=2)
        title = f"{finding.axis.name}, {STAGE_NAMES[channel.stage].lower()}"
        out.append((title, to_svg(made, title)))
    return out
