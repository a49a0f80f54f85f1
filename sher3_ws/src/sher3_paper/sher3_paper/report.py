"""The report: one HTML file with everything in it, and Markdown pages for the documentation."""

from __future__ import annotations

import base64
from collections import Counter
from pathlib import Path
from typing import Any

import jinja2
from sher3_description import load_robot

from sher3_paper.comparison import Section
from sher3_paper.figures import draw
from sher3_paper.tables import inconsistencies


def number(value: float | None) -> str:
    """Return a value with four significant digits, or a dash."""
    return "–" if value is None else f"{value:.4g}"


def html(sections: list[Section]) -> str:
    """Return the self-contained HTML report."""
    templates = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    templates.filters["number"] = number
    pictures = {
        section.name: [base64.b64encode(draw(name, arguments)).decode() for name, arguments in section.figures]
        for section in sections
    }
    return templates.get_template("report.html").render(
        sections=sections,
        pictures=pictures,
        counts=Counter(line.verdict for section in sections for line in section.comparisons),
        inconsistencies=inconsistencies(),
        digest=load_robot().digest()[:12],
    )


def markdown(sections: list[Section]) -> dict[str, str]:
    """Return Markdown pages by their names: the comparisons of each part, and the inconsistencies of the paper."""
    pages = {section.name: _page(section.title, _tables(section)) for section in sections}
    rows = [[i["id"], i["says"], i["finds"], i["position"]] for i in inconsistencies()]
    table = _table(["id", "the paper", "what we find", "position"], rows)
    return {**pages, "inconsistencies": _page("Inconsistencies of the paper and the position taken", table)}


def _page(title: str, lines: list[str]) -> str:
    return "\n".join([f"# {title}", "", "Written by `sher3 paper --markdown FOLDER`.", "", *lines]) + "\n"


def _tables(section: Section) -> list[str]:
    lines = _table(
        ["quantity", "unit", "printed", "computed", "verdict", "note", "command"],
        [
            [c.quantity, c.unit, number(c.printed), number(c.computed), c.verdict, c.note, f"`{c.command}`"]
            for c in section.comparisons
        ],
    )
    for table in section.tables:
        lines += ["", f"{table.title}:", "", *_table(table.columns, table.rows)]
    return lines


def _table(columns: list[str], rows: list[list[Any]]) -> list[str]:
    head = ["| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
    return head + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
