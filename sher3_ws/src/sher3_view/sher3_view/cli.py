"""The commands of this package: `view`, `analyze`, `state`, `foxglove`."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Annotated, Optional

import typer
from sher3_common.commands.completing import BAG, folders_with
from sher3_common.commands.options import Domain, InNamespace, Json, reported
from sher3_common.namespace import NAMESPACE

app = typer.Typer(rich_markup_mode="markdown")


@app.command(
    epilog="Examples: `sher3 view bags/trial --html trial.html` · "
    "`sher3 view` (the running robot) · `sher3 view bags/before --ghost bags/after --exaggerate 50 --html both.html` · "
    "`sher3 view bags/trial --simulated nominal --simulated corrected.yaml --exaggerate 50`"
)
def view(
    bag: Annotated[
        Path | None,
        typer.Argument(
            help="Bag folder or .mcap file; without one, the running robot is shown.", autocompletion=folders_with(BAG)
        ),
    ] = None,
    page: Annotated[Optional[Path], typer.Option("--html", help="File to write; default BAG.html.")] = None,  # noqa: UP045
    ghost: Annotated[
        Optional[list[Path]],  # noqa: UP045
        typer.Option(
            help="Another bag, drawn as a transparent robot; repeat for more.", autocompletion=folders_with(BAG)
        ),
    ] = None,
    simulated: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            help="The simulator driven as the recorded robot was, drawn as a transparent robot: `nominal` or a file of "
            "effects; repeat for more."
        ),
    ] = None,
    exaggerate: Annotated[
        float, typer.Option(help="Draw the distance of ghosts from the robot this many times as large.", min=1.0)
    ] = 1.0,
    robot: Annotated[Optional[Path], typer.Option(help="Robot file; by default the one in the bag.")] = None,  # noqa: UP045
    port: Annotated[int, typer.Option(help="Port of the live page, on 127.0.0.1 alone.", min=1, max=65535)] = 8080,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    seconds: Annotated[float | None, typer.Option("--for", help="Seconds the live page lasts; until Ctrl-C.")] = None,
    as_json: Json = False,
) -> None:
    """Show a recording, or the running robot, in three dimensions.

    A recording becomes one HTML file that opens in any browser, without network. The running robot is served live on
    this machine alone; that needs the extra `view`. The view moves nothing; on mocks it can ask for faults.
    """
    if bag is None:
        _live(robot, port, domain, seconds)
        return
    from sher3_bags import read_run
    from sher3_description import load_robot

    from sher3_view.film import film_of
    from sher3_view.ghosts_asked import ghosts_asked
    from sher3_view.page import write_page

    model = load_robot(robot) if robot else None
    run = read_run(bag, check=False)
    film = film_of(run, model)
    ghosts = ghosts_asked(film, run, ghost or [], simulated or [], exaggerate, model)
    target = write_page(film, page or bag.with_name(bag.name + ".html"), ghosts)
    facts = {"page": str(target), "bytes": target.stat().st_size, "frames": len(film.seconds)}
    typer.echo(json.dumps(facts) if as_json else f"page {target}: open it in a browser")


def _live(robot: Path | None, port: int, domain: int, seconds: float | None) -> None:
    from sher3_view.live.alone import show

    show(robot, port, domain, seconds)


@app.command(
    epilog="Examples: `sher3 analyze bags/trial --picture trial.png` · `sher3 analyze bags/trial --html trial.html`"
)
def analyze(
    bag: Annotated[Path, typer.Argument(help="Bag folder or .mcap file.", autocompletion=folders_with(BAG))],
    picture: Annotated[Path | None, typer.Option(help="Also draw the run to this PNG, PDF or SVG.")] = None,
    page: Annotated[
        Path | None, typer.Option("--html", help="Also write figures, picture and the robot in motion into one file.")
    ] = None,
    namespace: Annotated[str, typer.Option(help="Namespace of the robot in the bag.")] = NAMESPACE,
    as_json: Json = False,
) -> None:
    """Figures of a run: tip path, force against velocity, tracking per axis, timing and drops per topic."""
    from sher3_bags.cli import printed
    from sher3_bags.figures.analysis import analyse
    from sher3_bags.figures.report import analysis_text
    from sher3_bags.reading import read_run

    from sher3_view.figures import drawn, write_figures

    with reported(as_json):
        run = read_run(bag, namespace=namespace, check=False)
        analysis = analyse(run)
        data = analysis.to_dict()
        if picture is not None:
            data["picture"] = str(drawn(run, analysis, picture))
        if page is not None:
            data["page"] = str(write_figures(run, analysis, page))
        notes = [f"\n\n{name}: {data[name]}" for name in ("picture", "page") if name in data]
        printed(as_json, data, analysis_text(analysis) + "".join(notes))


@app.command(epilog="Examples: `sher3 state` beside `sher3 up` · `sher3 state --urdf sher3.urdf`")
def state(
    urdf_file: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--urdf", help="Write the robot's description to this file, and publish nothing."),
    ] = None,
    robot: Annotated[Optional[Path], typer.Option(help="Robot file; the nominal one by default.")] = None,  # noqa: UP045
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    parameters: Annotated[
        bool, typer.Option("--parameters", help="Also serve the settings as parameters of /sher3/parameters.")
    ] = False,
    crtk: Annotated[
        bool, typer.Option("--crtk", help="Also speak crtk_msgs on operating_state and state_command.")
    ] = False,
    seconds: Annotated[float | None, typer.Option("--for", help="Seconds it lasts; until Ctrl-C.")] = None,
    as_json: Json = False,
) -> None:
    """Publish the running robot for other ROS tools: description, joint states, transforms, legs, statuses, log.

    Topics: /robot_description, /joint_states, /tf, /tf_static, /sher3/markers, 50 times a second, and /sher3/typed/….
    A recording holds them anyway. Faults, refusals and complaints of nodes go to /rosout.
    """
    from sher3_description import load_robot

    model = load_robot(robot)
    if urdf_file is not None:
        from sher3_description.urdf import urdf

        urdf_file.write_text(urdf(model), encoding="utf-8")
        typer.echo(json.dumps({"urdf": str(urdf_file)}) if as_json else f"description in {urdf_file}")
        return
    from sher3_view.live.state_node import run

    say = partial(_note, as_json)
    with reported(as_json):
        run(model, domain, seconds, parameters, crtk, say)


@app.command(epilog="Example: `sher3 foxglove` beside `sher3 up`, then open ws://127.0.0.1:8765 in Foxglove")
def foxglove(
    port: Annotated[int, typer.Option(help="Port of the server, on 127.0.0.1 alone.", min=1, max=65535)] = 8765,
    robot: Annotated[Optional[Path], typer.Option(help="Robot file; the nominal one by default.")] = None,  # noqa: UP045
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    seconds: Annotated[float | None, typer.Option("--for", help="Seconds it lasts; until Ctrl-C.")] = None,
    as_json: Json = False,
) -> None:
    """Serve the running robot to Foxglove: every stream, the robot as a model with its frames, statuses as messages.

    It needs the extra `foxglove`. The server takes nothing from a viewer, so nothing moves by it.
    """
    from sher3_description import load_robot

    from sher3_view.live.foxglove_node import run

    run(load_robot(robot), port, domain, seconds, partial(_note, as_json))


def _note(as_json: bool, line: str) -> None:
    typer.echo(json.dumps({"note": line}) if as_json else line, err=True)
