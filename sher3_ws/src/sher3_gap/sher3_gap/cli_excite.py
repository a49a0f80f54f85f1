"""The `excite` and `monitor` commands."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from sher3_description import Robot, load_robot

from sher3_gap.excitation import Excitation, catalogue, excite


def chosen(which: str, robot: Robot, posture: str, duration: float) -> list[Excitation]:
    """Return the excitations asked for: a file, labels of the standard set separated by commas, or `all`.

    Raises:
        FileError, ExcitationError: no such file or excitation, or a limit is not kept.
    """
    from sher3_gap.excitation_file import load_excitation

    if which.endswith((".yaml", ".yml")):
        return [load_excitation(Path(which), robot)]
    labels = list(catalogue()) if which == "all" else [label for label in which.split(",") if label]
    return [excite(label, robot, posture=posture, duration=duration) for label in labels]


def listing() -> list[dict[str, Any]]:
    """Return the standard set as plain data."""
    return [{"name": e.name, "purpose": e.purpose, "separates": list(e.separates)} for e in catalogue().values()]


def listing_text() -> str:
    """Return the standard set as text."""
    lines = []
    for entry in listing():
        lines.append(f"{entry['name']:<10} {entry['purpose']}")
        lines += [f"{'':<10}   {line}" for line in entry["separates"]]
    return "\n".join([*lines, "", "A suffix scales it: sweep_0.8. `all` is the whole set."])


def excite_command(
    which: Annotated[
        str, typer.Argument(help="Names like sweep,steps_0.8, `all`, or an excitation file; a list of them without.")
    ] = "",
    out: Annotated[Path, typer.Option("--out", "-o", help="New case folder.")] = Path("case"),
    repeats: Annotated[int, typer.Option(min=1, max=50, help="Runs of each.")] = 3,
    posture: Annotated[str, typer.Option(help="Start posture: p0 to p3.")] = "p0",
    duration: Annotated[float, typer.Option(help="Seconds of each run.")] = 4.6,
    simulate: Annotated[bool, typer.Option("--simulate", help="Run them in the simulator, not on the graph.")] = False,
    effects: Annotated[Path | None, typer.Option(help="With --simulate: effects of the simulated robot.")] = None,
    seed: Annotated[int, typer.Option(help="With --simulate: of noise and scatter.")] = 0,
    robot: Annotated[Path | None, typer.Option(help="robot.yaml; the nominal robot by default.")] = None,
    domain: Annotated[int, typer.Option(min=0, max=232, help="ROS domain id of the graph.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """List the standard excitations, or run some on the running graph (or simulated) and record them as a case.

    The robot moves. On the graph it is enabled, goes to the start posture and follows the set-points within its limits;
    known tip loads are applied by the mock's plant, on a real robot by hand.
    """
    from sher3_gap.cli import reported
    from sher3_gap.cli_print import steps

    if not which:
        typer.echo(json.dumps({"excitations": listing()}) if as_json else listing_text())
        return
    with reported(as_json), steps() as say:
        model = load_robot(robot)
        wanted = [(e, r) for e in chosen(which, model, posture, duration) for r in range(repeats)]
        if simulate:
            _simulate(model, wanted, out, effects, seed)
        else:
            _on_graph(model, wanted, out, say, domain)
    data = {"case": str(out), "runs": len(wanted)}
    typer.echo(json.dumps(data) if as_json else f"{len(wanted)} runs in {out}; next: sher3 gap diagnose {out}")


def _simulate(robot: Robot, wanted: list[tuple[Excitation, int]], out: Path, effects: Path | None, seed: int) -> None:
    from sher3_bags import write_case
    from sher3_sim import load_effects

    from sher3_gap.rehearsal import rehearse

    given = load_effects(effects) if effects else []
    write_case(out, rehearse(robot, wanted, given, seed=seed), robot)


def _on_graph(
    robot: Robot, wanted: list[tuple[Excitation, int]], out: Path, say: Callable[[str], None], domain: int
) -> None:
    from sher3_gap.excite_node import excite_graph

    excite_graph(robot, wanted, out, say, domain)


def monitor_command(
    effects: Annotated[Path | None, typer.Option(help="Effects of the model; nominal without.")] = None,
    window: Annotated[float, typer.Option(min=0.5, max=60.0, help="Seconds a gap is taken over.")] = 4.0,
    robot: Annotated[Path | None, typer.Option(help="robot.yaml; the nominal robot by default.")] = None,
    domain: Annotated[int, typer.Option(min=0, max=232, help="ROS domain id of the graph.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Also print one JSON object a second.")] = False,
) -> None:
    """Run the model beside the running robot; gap over floor per stage on gap/diagnostics at 1 Hz, until Ctrl-C."""
    from sher3_sim import load_effects

    from sher3_gap.cli import reported
    from sher3_gap.gap_monitor_node import StageStatus, judged_json, run

    def told(stamp: int, found: list[StageStatus]) -> None:
        print(judged_json(stamp, found), flush=True)

    with reported(as_json):
        run(load_robot(robot), load_effects(effects) if effects else [], window, domain, told if as_json else None)
