"""Commands `design` and `paper`: the optimisation, and everything the paper computes beside what it prints."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated

import typer
from sher3_common import make_folder
from sher3_common.commands.options import reported

app = typer.Typer(no_args_is_help=True, help="The SHER 3.0 paper recomputed.")

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@app.command()
def design(
    reading: Annotated[str, typer.Option(help="Reading of the radii: circumradius or midplane.")] = "circumradius",
    constraints: Annotated[str, typer.Option(help="stated, relaxed or reach.")] = "stated",
    poses: Annotated[int, typer.Option(help="Positions over the workspace per design.", min=1)] = 432,
    torque: Annotated[float, typer.Option(help="Moment [N m] at which T_c is taken.")] = 1.0,
    fine: Annotated[int, typer.Option(help="Search at least this many designs instead of the paper's 960.")] = 0,
    jobs: Annotated[int, typer.Option(help="Processes of a fine search.")] = 1,
    dask: Annotated[str | None, typer.Option(help="Address of a Dask scheduler for a fine search.")] = None,
    figure: Annotated[Path | None, typer.Option(help="Write the pictures of the search to this PNG.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Search the designs of the paper for stiffness and conditioning, and say where its choice stands.

    Examples:
        sher3 design

        sher3 design --constraints relaxed --reading midplane --json

        sher3 design --fine 1000000 --jobs 2
    """
    from sher3_paper.search.optimise import fine_grid, search, search_parallel
    from sher3_paper.search.summary import choices, summary, text

    with reported(as_json):
        taken, chosen_set = choices(reading, constraints)
        start = time.perf_counter()
        if fine:
            found = search_parallel(fine_grid(fine), taken, poses, jobs, dask)
        else:
            found = search(reading=taken, poses=poses, torque=torque)
        seconds = time.perf_counter() - start
        result = summary(found, chosen_set, seconds)
        if figure is not None:
            from sher3_paper.figures import draw

            picture = {"found": found, "sets": {constraints: chosen_set}} if fine else {"found": found}
            figure.write_bytes(draw("pareto" if fine else "trends", picture))
    typer.echo(json.dumps(result, indent=2) if as_json else text(result))


@app.command()
def paper(
    out: Annotated[Path | None, typer.Option(help="Folder for report.html; made if missing.")] = None,
    markdown: Annotated[Path | None, typer.Option(help="Folder for the tables as Markdown, a page a part.")] = None,
    only: Annotated[list[str] | None, typer.Option(help="Only this part; may be repeated.")] = None,
    benchtop: Annotated[Path | None, typer.Option(help="Results of a bench-top evaluation (JSON).")] = None,
    as_json: JsonOption = False,
) -> None:
    """Recompute every table and figure of the paper, printed beside computed, with a verdict for each.

    Parts: geometry, torsion, identification, design, grasp, compensation, benchtop.

    Examples:
        sher3 paper --out report

        sher3 paper --only design --only torsion

        sher3 paper --json
    """
    with reported(as_json):
        from sher3_paper.report import html
        from sher3_paper.report import markdown as as_markdown
        from sher3_paper.sections import build

        sections = build(only, benchtop)
        if markdown is not None:
            make_folder(markdown)
            for name, text in as_markdown(sections).items():
                (markdown / f"{name}.md").write_text(text, encoding="utf-8")
        if out is not None:
            make_folder(out)
            (out / "report.html").write_text(html(sections), encoding="utf-8")
    if as_json:
        typer.echo(json.dumps([section.to_dict() for section in sections], indent=2))
        return
    for section in sections:
        typer.echo(f"\n{section.title}")
        for line in section.comparisons:
            values = f"{_short(line.printed):>9s} {_short(line.computed):>9s} {line.unit:10s}"
            typer.echo(f"  {line.quantity:46s} {values} {line.verdict:12s} {line.note}")
    if out is not None:
        typer.echo(f"\nwrote {out / 'report.html'}")


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


if __name__ == "__main__":
    app()
