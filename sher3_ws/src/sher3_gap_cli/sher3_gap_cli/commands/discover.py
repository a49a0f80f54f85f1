"""`sher3 gap discover`: a formula for a gap that no effect of the library explains."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import Library, RequestError, RobotFile, Trust, check_writable, reported

if TYPE_CHECKING:
    from sher3_diagnosis.channel import Channel
    from sher3_diagnosis.discover.formula import Discovery
    from sher3_diagnosis.verdict import Verdict


def discover(
    case: Annotated[Path, typer.Argument(help="Case folder.")],
    robot: RobotFile = None,
    where: Annotated[
        str, typer.Option("--place", help="STAGE/ACTUATOR to look at; default where the library leaves most.")
    ] = "",
    without: Annotated[list[str] | None, typer.Option(help="Leave this effect out; repeat for more.")] = None,
    save: Annotated[Path | None, typer.Option(help="YAML file that makes the formula a page of the library.")] = None,
    name: Annotated[str, typer.Option(help="Effect id of the saved page; default from the place.")] = "",
    out: Annotated[Path | None, typer.Option(help="Folder for report.html; default none.")] = None,
    own: Library = None,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """Find a sparse formula, with units, for a gap outside the library; it is scored on runs left out.

    Nothing is claimed where the formula does not hold on those. Beside it stands what boosted trees of the same inputs
    close, the ceiling.
    """
    from sher3_diagnosis.discover.discover import discover as search
    from sher3_diagnosis.report.found import found_data, found_text
    from sher3_effects import add_library
    from sher3_effects.found_page import save_found

    from sher3_gap_cli.answers import REPORT_FILE, Task, check_effects, diagnosed
    from sher3_gap_cli.printing import steps

    with reported(as_json), steps() as say:
        check_writable([save], [out])
        add_library(own or [], trust)
        place = _channel(where)
        diagnosis = diagnosed(Task(case, robot, check_effects(without or [])), say)
        found = search(diagnosis, place, say)
        left = others(diagnosis.verdict, found) if found.claimed else []
        if save is not None and found.claimed:
            save_found(found, name or f"found_{found.channel.stage}_{found.channel.actuator}", save)
        if out is not None:
            from sher3_diagnosis.report.page import render

            out.mkdir(parents=True, exist_ok=True)
            page = render(diagnosis, case.resolve().name, found, case=str(case))
            (out / REPORT_FILE).write_text(page, encoding="utf-8")
    saved = str(save) if save is not None and found.claimed else None
    if as_json:
        typer.echo(json.dumps({"case": str(case), "saved": saved, **found_data(found)}))
        return
    typer.echo(found_text(found))
    typer.echo("".join(f"left     no cause at {text} either: give --place {text}\n" for text in left), nl=False)
    if saved:
        typer.echo(f"saved    {saved}: `sher3 gap diagnose --library {saved} CASE` finds it again")


def others(verdict: Verdict, found: Discovery) -> list[str]:
    """Return STAGE/ACTUATOR of the places without a cause, but for those a formula was looked for at."""
    known = {(c.stage, c.actuator) for c in verdict.causes} | {(c.stage, c.actuator) for c in found.channels}
    places = [(w.stage, w.actuator) for w in verdict.where]
    return [f"{stage}/{actuator}" for stage, actuator in places if (stage, actuator) not in known]


def _channel(text: str) -> Channel | None:
    """Return the channel of STAGE/ACTUATOR, None for nothing; raises RequestError."""
    from sher3_diagnosis.channel import STAGES, Channel

    if not text:
        return None
    stage, _, actuator = text.partition("/")
    if stage not in STAGES or not actuator:
        raise RequestError("no such place", value=text, limit=", ".join(STAGES), remedy="as in motor_mechanics/tilt")
    return Channel(stage, actuator)
