"""The report: one HTML file with everything in it, and a Markdown table for the documentation."""

from __future__ import annotations

import base64
from collections import Counter
from pathlib import Path

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


def markdown(sections: list[Section]) -> str:
    """Return the comparisons and the inconsistencies as Markdown tables."""
    lines = ["# The paper recomputed: printed and computed values", "", "Written by `sher3 paper --markdown FILE`.", ""]
    for section in sections:
        lines += [f"## {section.title}", "", "| quantity | unit | printed | computed | verdict | note | command |"]
        lines.append("|---|---|---|---|---|---|---|")
        for c in section.comparisons:
            cells = [c.quantity, c.unit, number(c.printed), number(c.computed), c.verdict, c.note, f"`{c.command}`"]
            lines.append("| " + " | ".join(cells) + " |")
        for table in section.tables:
            lines += [
                "",
                f"{table.title}:",
                "",
                "| " + " | ".join(table.columns) + " |",
                "|---" * len(table.columns) + "|",
            ]
            lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in table.rows]
        lines.append("")
    lines += ["## Inconsistencies of the paper and the position taken", ""]
    lines += ["| id | the paper | what we find | position |", "|---|---|---|---|"]
    lines += [f"| {i['id']} | {i['says']} | {i['finds']} | {i['position']} |" for i in inconsistencies()]
    return "\n".join(lines) + "\n"
