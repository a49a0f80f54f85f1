"""Command `benchtop`: the paper's bench-top tests on the running graph."""

from __future__ import annotations

import json
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer
from sher3_bringup.errors import ConfigurationError
from sher3_common import make_folder

if TYPE_CHECKING:
    from sher3_description import Robot
    from sher3_sim import PlantEffect

app = typer.Typer(no_args_is_help=True)
HELP_OUT = "Folder for bags, figures (benchtop.json), text, picture and effects; bags are kept only with it."


@app.command(epilog="Examples: `sher3 benchtop --fast` · `sher3 benchtop --out bench`")
def benchtop(
    nominal: Annotated[bool, typer.Option("--nominal", help="The plant does what the model says.")] = False,
    built: Annotated[bool, typer.Option("--as-built", help="A robot built to tolerances (default).")] = False,
    effects: Annotated[Optional[Path], typer.Option(help="Another robot (YAML, sher3.effects/1).")] = None,  # noqa: UP045
    fast: Annotated[bool, typer.Option("--fast", help="Two visits and one push instead of five and three.")] = False,
    test: Annotated[Optional[list[str]], typer.Option(help="Only this test; may be repeated.")] = None,  # noqa: UP045
    compensate: Annotated[bool, typer.Option("--compensate", help="Compensate the deflection under load.")] = False,
    centre: Annotated[tuple[float, float, float], typer.Option(help="Centre of the grids from home [mm].")] = (0, 0, 0),
    force: Annotated[tuple[float, float], typer.Option(help="Ends of the force in the deflection test [N].")] = (-6, 8),
    spread: Annotated[int, typer.Option(help="Only the accuracy of so many robots, without the graph.", min=0)] = 0,
    out: Annotated[Optional[Path], typer.Option(help=HELP_OUT)] = None,  # noqa: UP045
    again: Annotated[
        bool, typer.Option("--again", help="Read the bags of a former run in --out; run nothing.")
    ] = False,
    jobs: Annotated[int, typer.Option(help="Tests at a time.", min=1, max=5)] = 1,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as one JSON object.")] = False,
) -> None:
    """Command the robot through the paper's bench-top tests and print its tables beside ours.

    Tests: grid_10mm, grid_2mm, grid_10um, rotation, deflection; in position mode over the CAN mocks and the plant, in
    stepped time. `sher3 paper --benchtop benchtop.json` takes the figures into the report.
    """
    from sher3_description import load_robot

    from sher3_benchtop.fixture import bench_robot
    from sher3_benchtop.protocol.plan import FAST, TESTS, Plan

    if nominal + built + (effects is not None) > 1:
        raise ConfigurationError("--nominal, --as-built and --effects exclude each other", remedy="choose one robot")
    if again and out is None:
        raise ConfigurationError("--again needs the bags of a former run", remedy="give its folder with --out")
    names = test or list(TESTS)
    for name in names:
        if name not in TESTS:
            raise ConfigurationError("no such test", value=name, limit=", ".join(TESTS), remedy="choose one of these")
    robot = bench_robot(load_robot())
    if spread:
        _print_spread(robot, spread, as_json)
        return
    plan = replace(
        FAST if fast else Plan(),
        centre=in_metres(centre),
        pull=min(force),
        push=max(force),
        dwell=1.2 if compensate else 0.4,
    )
    kind, chosen = _robot(nominal, effects)
    _run(names, robot, plan, kind, chosen, compensate, out, again, jobs, as_json)


def in_metres(millimetres: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return three lengths [mm] in m."""
    x, y, z = millimetres
    return 1e-3 * x, 1e-3 * y, 1e-3 * z


def _robot(nominal: bool, effects: Path | None) -> tuple[str, list[PlantEffect]]:
    from sher3_effects import load_effects

    from sher3_benchtop.as_built import FILE

    if nominal:
        return "nominal", []
    return ("as built", load_effects(FILE)) if effects is None else (str(effects), load_effects(effects))


def _run(
    names: list[str],
    robot: Robot,
    plan: Any,
    kind: str,
    effects: list[PlantEffect],
    compensate: bool,
    out: Path | None,
    again: bool,
    jobs: int,
    as_json: bool,
) -> None:
    from sher3_control.settings import ControlSettings
    from sher3_effects import save_effects

    from sher3_benchtop.cameras.camera import READINGS
    from sher3_benchtop.evaluation.evaluate import evaluate
    from sher3_benchtop.evaluation.picture import draw
    from sher3_benchtop.evaluation.text import as_text, flat
    from sher3_benchtop.graph.runs import run_tests

    control = ControlSettings.from_robot(robot, {"motion": {"deflection_compensation": compensate, "regime": "bench"}})
    with tempfile.TemporaryDirectory() as scratch:
        bags = Path(scratch) if out is None else out / "bags"
        make_folder(bags)
        shots = run_tests(names, robot, plan, effects, bags, control, _say, again, jobs)
    figures = {reading: evaluate(shots, reading) for reading in READINGS}
    title = f"Robot {kind}" + (", deflection compensated" if compensate else "")
    text, data = as_text(figures, title), json.dumps(flat(figures), indent=2)
    if out is not None:
        (out / "benchtop.txt").write_text(text + "\n", encoding="utf-8")
        (out / "benchtop.json").write_text(data + "\n", encoding="utf-8")
        save_effects(out / "effects.yaml", effects)
        draw(shots, out / "benchtop.png")
    typer.echo(data if as_json else text)


def _say(text: str) -> None:
    typer.echo(text, err=True)


def _print_spread(robot: Robot, robots: int, as_json: bool) -> None:
    from sher3_benchtop.evaluation.spread import accuracy_spread
    from sher3_benchtop.evaluation.text import spread_text

    found = accuracy_spread(robot, robots)
    data = {name: values.tolist() for name, values in found.items()}
    typer.echo(json.dumps(data, indent=2) if as_json else spread_text(found, robots))
