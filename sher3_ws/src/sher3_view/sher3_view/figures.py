"""The figures of a recording as a section of its page: tables, and the picture inside the file."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable
from pathlib import Path

from sher3_bags import Run
from sher3_bags.figures.analysis import Analysis
from sher3_bags.figures.picture import draw, png
from sher3_bags.figures.report import Block, analysis_blocks
from sher3_description import Robot

from sher3_view.errors import ViewError
from sher3_view.film import film_of
from sher3_view.page import write_page


def figures_section(run: Run, analysis: Analysis, more: Iterable[Block] = ()) -> str:
    """Return the section as HTML; it needs no other file. `more` stands below the figures of the run."""
    image = base64.b64encode(png(run, analysis)).decode("ascii")
    blocks = "\n".join(map(_block, [*analysis_blocks(analysis), *more]))
    alt = "tip path, force against velocity, tracking, what happened over time, arrival times, drops"
    picture = f'<img alt="{alt}" src="data:image/png;base64,{image}">'
    return f'<section class="figures"><h2>Figures</h2>\n{blocks}\n{picture}</section>'


def write_figures(
    run: Run, analysis: Analysis, path: Path, robot: Robot | None = None, more: Iterable[Block] = ()
) -> Path:
    """Write the robot in motion with its figures as one page that opens without network; return its path.

    Args:
        run: to show.
        analysis: its figures.
        path: of the page.
        robot: in force; that of the recording by default.
        more: further tables below the figures.

    Raises:
        ViewError: the run has nothing to show, or the file cannot be written.
    """
    return write_page(film_of(run, robot), path, figures=figures_section(run, analysis, more))


def drawn(run: Run, analysis: Analysis, path: Path) -> Path:
    """Draw the picture of a run; return its path.

    Raises:
        ViewError: it cannot be written, or not in this format.
    """
    try:
        return draw(run, analysis, path)
    except (OSError, ValueError) as error:
        raise ViewError(f"{path} cannot be drawn ({error})", remedy="name a writable .png, .pdf or .svg") from error


def _block(block: Block) -> str:
    if not block.rows:
        return f"<p>{html.escape(block.text)}</p>"
    rows = "\n".join(_row("td", row) for row in block.rows)
    return f"<h3>{html.escape(block.text)}</h3>\n<table>\n{_row('th', block.header)}\n{rows}\n</table>"


def _row(cell: str, values: Iterable[object]) -> str:
    return "<tr>" + "".join(f"<{cell}>{html.escape(str(value))}</{cell}>" for value in values) + "</tr>"
