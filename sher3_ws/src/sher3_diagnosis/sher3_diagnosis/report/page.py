"""The page: collects the sections and fills the template."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import jinja2

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.discover.formula import Discovery
from sher3_diagnosis.localise.regimes import regime_powers
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.report.causes import cause_cards
from sher3_diagnosis.report.chain import chain
from sher3_diagnosis.report.found import closures, found_rows
from sher3_diagnosis.report.odds import answered, sizes
from sher3_diagnosis.report.summary import command, five_lines, headline, noise_text
from sher3_diagnosis.report.traces import traces
from sher3_diagnosis.words import place, quantity, ratio_text, share, words

TEMPLATE = "template.html"
SHOWN = 4
"""Channels shown, those with the largest gap."""
ROWS = 10
"""Regimes shown of a channel, those with the largest gap."""
ABOVE_FLOOR = 1.16
"""Rms over floor from which a regime is coloured as one with a gap: the power of a gap that is just significant."""
SHORTEST = 1.5
"""Rms over floor that a full bar stands for at least, so that regimes at the floor do not look large."""
CORRECTED = 'v.corrected("fixed.xml")', "writes the model with the causes in it"
"""What goes on from an answer `v` in memory, and what it does."""


def render(
    diagnosis: Diagnosis,
    title: str,
    found: Discovery | None = None,
    folder: str = "",
    case: str = "",
    in_memory: bool = False,
    options: str = "",
) -> str:
    """Return the report of a diagnosis as one HTML page without external resources.

    Args:
        diagnosis: of any machine.
        title: name of the case.
        found: a discovered formula, if one was looked for.
        folder: where the verdict is written; default `gap/<title>`.
        case: folder of the case; default its name.
        in_memory: whether the case is in no folder: what goes on from here is a method of the answer.
        options: of the diagnosis, as in `command`.
    """
    sections = _sections(diagnosis, title, (case or title, folder, options), in_memory)
    return _template().render(found=_formula(found), **sections)


@cache
def _template() -> jinja2.Template:
    """Return the page to be filled, compiled once."""
    loader = jinja2.PackageLoader("sher3_diagnosis", "report")
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    said: dict[str, Any] = {f.__name__: f for f in SAID}
    environment.globals.update(said)
    environment.filters["words"] = words
    return environment.get_template(TEMPLATE)


def percent(part: float | None) -> str:
    """Return a share as the length of a bar, percent; none below zero."""
    return f"{100.0 * max(part or 0.0, 0.0):.1f}"


SAID = (words, place, quantity, share, ratio_text, answered, sizes, percent)
"""How the template says what it finds in a verdict."""


def _sections(diagnosis: Diagnosis, title: str, typed: tuple[str, str, str], in_memory: bool) -> dict[str, object]:
    verdict, reporter = diagnosis.verdict, diagnosis.machine.reporter()
    parts = [f.evidence for f in diagnosis.findings]
    rests = {e.id: e.leaves_out for e in diagnosis.machine.library() if e.leaves_out}
    table = reporter.table(diagnosis)
    lines = five_lines(verdict, reporter, rests, table, *typed)
    going = command(verdict, reporter, *typed)
    if in_memory and going is not None:
        going = CORRECTED if verdict.causes else None
        lines = [(head, text) for head, text in lines if head != "next"]
    return dict(
        title=title,
        verdict=verdict,
        reporter=reporter,
        headline=headline(verdict, rests),
        lines=lines,
        picture=reporter.picture(diagnosis),
        command=going,
        data=reporter.data(parts),
        noise=noise_text(verdict.noise),
        chain=chain(diagnosis, reporter),
        traces=traces(diagnosis, reporter),
        table=table,
        causes=cause_cards(diagnosis),
        regimes=regimes(diagnosis),
        isolability=reporter.isolability(parts),
    )


def _formula(found: Discovery | None) -> dict[str, object] | None:
    """Return a discovery as the page shows it; None where none was looked for."""
    if found is None:
        return None
    where = "" if not found.channels else f"{words(found.channel.stage)}, {place(found.channel.actuator)}"
    rows = found_rows(found) if found.claimed else []
    return {"where": where, "rows": rows, "closes": closures(found) if rows else "", "note": found.note}


class Regimes(NamedTuple):
    """Rms over floor of a channel by regime, largest first; what a full bar stands for, and where a gap begins."""

    at: Channel
    ratios: list[tuple[str, float]]
    full: float
    gap_from: float = ABOVE_FLOOR


def regimes(diagnosis: Diagnosis) -> list[Regimes]:
    """Return the regimes of the channels with a gap."""
    gaps = [(g, f.evidence) for f in diagnosis.findings for g in f.gaps if g.significant]
    out = []
    for gap, evidence in sorted(gaps, key=lambda pair: -pair[0].power)[:SHOWN]:
        powers = regime_powers(evidence, gap.channel)
        ratios = sorted(((n, p**0.5) for n, p in powers.items()), key=lambda x: -x[1])[:ROWS]
        out.append(Regimes(gap.channel, ratios, max((SHORTEST, *(r for _, r in ratios)))))
    return out
