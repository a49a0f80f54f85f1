"""Write the pages of the safety matrix from what `sher3 safety --jobs 2` left in its folder: safety_page.py FOLDER."""

from __future__ import annotations

import sys
import textwrap
from datetime import date
from pathlib import Path

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "safety-matrix.md"
INTRODUCTION = """# Safety matrix

The table of the faults, as `sher3 safety` writes it into `report.md` of its folder (`--out`, by default
`bags/safety`); `tools/safety_page.py` makes these pages of it. What a cell is, when it holds and how it is measured
stands in [matrix](matrix.md); why some rows go on stands in the report.

"""
WIDTH = 118
KINDS = {
    "processes": ("Processes", {"process", "fault"}),
    "clocks": ("Clocks", {"clock"}),
    "sensors": ("Force sensor and pedal", {"force_sensor", "pedal"}),
    "bus": ("Bus and wires", {"bus", "bus0", "bus1", "wires"}),
    "encoders": ("Encoders", {"encoders", "load_encoder", "motor_encoder"}),
    "demands": ("Demands inside the drives", {"demand"}),
    "frames": ("Frames of a drive", {"up", "down", "echo", "statusword"}),
    "drives": ("Drives, motors and power", {"power", "motor", "delta_1", "delta_2", "safe_torque_off"}),
}
"""Pages of the table: a row is on the first of which it has the first or the last word of its component."""


def kind_of(row: str) -> str:
    """Return the page of a row, `| delta_1.power creep (speed 0.001) | ...`."""
    words = row.split()[1].rstrip(",").split(".")
    return next(kind for kind, (_, names) in KINDS.items() if names & {words[0], words[-1]})


def pages(report: str) -> dict[str, str]:
    """Return the text of every page of a report by its path: what was run and what misses; the rows of each kind."""
    _, _, rest = report.partition("\n")
    told, _, _ = rest.strip().replace("um]", "µm]").partition("\n## What goes on")
    head, rule, *rows = [line for line in told.splitlines() if line.startswith("|")]
    of_kind = {kind: [row for row in rows if kind_of(row) == kind] for kind in KINDS}
    prose = [textwrap.fill(line, WIDTH) for line in told.splitlines() if not line.startswith("|")]
    index = [f"| [{title}](safety-matrix/{kind}.md) | {len(of_kind[kind])} |" for kind, (title, _) in KINDS.items()]
    said = "\n".join(["| faults of | rows |", "|---|---|", *index, "", *prose]).rstrip()
    tables = {
        f"safety-matrix/{kind}.md": "\n".join([f"# Safety matrix: {title.lower()}\n", head, rule, *of_kind[kind], ""])
        for kind, (title, _) in KINDS.items()
    }
    return {PAGE.name: f"{INTRODUCTION}Figures of {date.today()}.\n\n{said}\n", **tables}


if __name__ == "__main__":
    (PAGE.parent / "safety-matrix").mkdir(exist_ok=True)
    for name, text in pages((Path(sys.argv[1]) / "report.md").read_text(encoding="utf-8")).items():
        (PAGE.parent / name).write_text(text, encoding="utf-8")
