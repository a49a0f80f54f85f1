"""The table of the front page, what can be told and how often, made of the figures of `docs/reference/told.md`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from generators.table import table

HEAD = ("what can be told", "single axis", "arm in motion", "servo without efforts", "this robot", "measured machines")
ROWS = (
    ("dry friction; viscous friction", "{axis:dry friction}; {axis:viscous friction}",
     "{arm:dry friction}; {arm:viscous friction}", "{servo:dry friction}; –", "yes",
     "{measured:dry friction}; {measured:viscous friction}"),
    ("friction at rest; friction by load", "{axis:friction at rest}; yes",
     "{arm:friction at rest (Stribeck)}; {arm:friction by load}", "–", "yes", "–"),
    ("mass, rotor, payload; weight", "{axis:mass}; {axis:weight}", "{arm:rotor+payload}; yes", "–; {servo:weight}",
     "yes", "{measured:mass, inertia, payload}; –"),
    ("gain of a drive; its limit", "{axis:gain of the drive}; yes", "{arm:gain of a servo}; –", "–; top speed", "yes",
     "–; {measured:limit of a drive}"),
    ("lag; delay of a command", "law stated", "–; {arm:command 12 steps late}, with rivals",
     "{servo:lag}; {servo:delay beside the lag}", "yes", "{measured:lag of a servo}; –"),
    ("late effort or encoder", "{axis:late effort}", "yes", "yes", "–", "{measured:late second encoder}"),
    ("springs, cables beside a joint", "{axis:spring}", "{arm:spring at a joint}", "–", "yes", "–"),
    ("play, springs, loops of a gear", "two encoders; play and springs with one", "two encoders", "two encoders", "yes",
     "{measured:spring, loop, ratio of a gear}"),
    ("cogging, ripple, eccentricity, lead error", "yes", "cogging {arm:cogging}", "all but cogging", "yes",
     "{measured:wave between encoders}"),
    ("geometry, zeros, skew, bending", "–", "from measured poses", "–", "yes", "{measured:zeros and geometry}"),
    ("changes between days, gains, payloads", "yes", "yes", "yes", "yes", "–"),
)  # fmt: skip
"""What stands in each row; in braces a table of `told.md` and one of its rows, or several whose counts are added up."""
COLUMNS = {"arm": ("fault", 1), "axis": ("cause, ", 1), "servo": ("cause, ", 2), "measured": ("cause", 1)}
"""Table -> how its head begins, and the column of its figures."""
COUNT = re.compile(r"(\d+) of (\d+)")
FIGURE = re.compile(r"\{(\w+):([^}]+)\}")


def page(told: Path, readme: Path) -> str:
    """Return the front page with its table as the figures are."""
    figures = figures_of(told.read_text(encoding="utf-8"))
    rows = [[FIGURE.sub(lambda m: _added(figures[m[1]], m[2]), cell) for cell in row] for row in ROWS]
    before, _, rest = readme.read_text(encoding="utf-8").partition(f"| {HEAD[0]} |")
    return before + table(HEAD, rows) + "\n" + rest.partition("\n\n")[2]


def figures_of(text: str) -> dict[str, dict[str, tuple[int, int]]]:
    """Return table -> row -> how often it was told, and of how many."""
    found: dict[str, dict[str, tuple[int, int]]] = {name: {} for name in COLUMNS}
    for block in text.split("\n\n"):
        lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in block.split("\n") if "|" in line]
        for name, (head, column) in COLUMNS.items():
            if lines and (lines[0][0] == head or (head.endswith(" ") and lines[0][0].startswith(head))):
                found[name] |= _counts(lines[2:], column)
    return found


def _counts(lines: list[list[str]], column: int) -> dict[str, tuple[int, int]]:
    told = {line[0]: COUNT.match(line[column]) for line in lines}
    return {name: (int(m[1]), int(m[2])) for name, m in told.items() if m}


def _added(known: Mapping[str, tuple[int, int]], rows: str) -> str:
    each = [known[row] for row in rows.split("+")]
    return f"{sum(told for told, _ in each)} of {sum(of for _, of in each)}"
