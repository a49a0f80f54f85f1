"""Write docs/reference/safety-matrix.md from what `sher3 safety --jobs 2` left in its folder: safety_page.py FOLDER."""

from __future__ import annotations

import sys
import textwrap
from datetime import date
from pathlib import Path

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "safety-matrix.md"
INTRODUCTION = """# Safety matrix

The table of the faults, as `sher3 safety` writes it into `report.md` of its folder (`--out`, by default
`bags/safety`); `tools/safety_page.py` makes this page of it. What a cell is, when it holds and how it is measured
stands in [matrix](matrix.md); why some rows go on stands in the report.

"""
WIDTH = 118


def page(report: str) -> str:
    """Return the page of a report: what was run, the table, what misses."""
    _, _, rest = report.partition("\n")
    told, _, _ = rest.strip().replace("um]", "µm]").partition("\n## What goes on")
    lines = [line if line.startswith("|") else textwrap.fill(line, WIDTH) for line in told.splitlines()]
    return f"{INTRODUCTION}Figures of {date.today()}.\n\n" + "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page((Path(sys.argv[1]) / "report.md").read_text(encoding="utf-8")), encoding="utf-8")
