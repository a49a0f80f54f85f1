"""The page: collects the sections and fills the template."""

from __future__ import annotations

from pathlib import Path

import jinja2
from matplotlib import rc_context

from sher3_gap.diagnose import Diagnosis
from sher3_gap.report.causes import cause_cards
from sher3_gap.report.chain import stages
from sher3_gap.report.closures import closure_bars
from sher3_gap.report.experiment_card import experiment_card
from sher3_gap.report.free_run import free_run_trace
from sher3_gap.report.isolability import group_rows, recorded_topics, structure_of
from sher3_gap.report.regimes import regimes
from sher3_gap.report.style import STAGE_NAMES, STYLE, place, words
from sher3_gap.report.summary import five_lines, headline
from sher3_gap.report.traces import traces

TEMPLATE = "template.html"


def render(diagnosis: Diagnosis, title: str) -> str:
    """Return the report of a diagnosis as one HTML page without external resources."""
    loader = jinja2.PackageLoader("sher3_gap", "report")
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    with rc_context(STYLE):
        return environment.get_template(TEMPLATE).render(**_sections(diagnosis, title))


def _sections(diagnosis: Diagnosis, title: str) -> dict[str, object]:
    verdict, runs = diagnosis.verdict, diagnosis.evidence.runs
    structure = structure_of(runs)
    excitations = sorted({r.excitation for r in runs})
    return dict(
        title=title,
        verdict=verdict,
        headline=headline(verdict),
        lines=five_lines(verdict),
        runs=len(runs),
        duration=sum(r.ticks * r.period for r in runs),
        excitations=[f"{e} × {sum(r.excitation == e for r in runs)}" for e in excitations],
        stages=stages(diagnosis),
        traces=traces(diagnosis),
        tip=free_run_trace(diagnosis),
        closures=closure_bars(verdict),
        causes=cause_cards(diagnosis, structure),
        regimes=regimes(diagnosis),
        groups=group_rows(structure),
        invisible=sorted(words(e) for e in structure.invisible),
        topics=sorted(recorded_topics(runs)),
        experiment=experiment_card(verdict),
        stage_names=STAGE_NAMES,
        place=place,
    )


def write_report(diagnosis: Diagnosis, path: Path, title: str) -> Path:
    """Write the report and return its path."""
    path.write_text(render(diagnosis, title), encoding="utf-8")
    return path
