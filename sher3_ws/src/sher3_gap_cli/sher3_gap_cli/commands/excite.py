"""`sher3 gap excite`: standard excitations on the running graph or in the simulator, recorded as a case."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from sher3_common.commands.options import Domain, InNamespace, Json
from sher3_common.namespace import NAMESPACE
from sher3_common.progress import Say

from sher3_gap_cli.options import NominalFile, echo_result, reported

if TYPE_CHECKING:
    from sher3_description import Robot
    from sher3_gap.excitation import Excitation


def chosen(which: str, robot: Robot, posture: str, duration: float) -> list[Excitation]:
    """Return the excitations asked for: a file, labels of the standard set separated by commas, or `all`.

    Raises:
        FileError, ExcitationError: no such file or excitation, or a limit is not kept.
    """
    from sher3_gap.excitation import catalogue
    from sher3_gap.excitation import excite as excited
    from sher3_gap.excitation.file import load_excitation

    if which.endswith((".yaml", ".yml")):
        return [load_excitation(Path(which), robot)]
    labels = list(catalogue()) if which == "all" else [label for label in which.split(",") if label]
    return [excited(label, robot, posture=posture, duration=duration) for label in labels]


def listing() -> list[dict[str, Any]]:
    """Return the standard set as plain data."""
    from sher3_gap.excitation import catalogue

    return [{"name": e.name, "purpose": e.purpose, "separates": list(e.separates)} for e in catalogue().values()]


def listing_text() -> str:
    """Return the standard set as text."""
    lines = []
    for entry in listing():
        lines.append(f"{entry['name']:<10} {entry['purpose']}")
        lines += [f"{'':<10}   {line}" for line in entry["separates"]]
    return "\n".join([*lines, "", "A suffix scales it: sweep_0.8. `all` is the whole set."])


def excite(
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
    robot: NominalFile = None,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    as_json: Json = False,
) -> None:
    """List the standard excitations, or run some on the running graph (or simulated) and record them as a case.

    The robot moves. On the graph it is enabled, goes to the start posture and follows the set-points within its limits;
    known tip loads are applied by the mock's plant, on a real robot by hand.
    """
    from sher3_description import load_robot

    from sher3_gap_cli.printing import steps

    if not which:
        echo_result(as_json, {"excitations": listing()}, listing_text())
        return
    with reported(as_json), steps() as say:
        model = load_robot(robot)
        wanted = [(e, r) for e in chosen(which, model, posture, duration) for r in range(repeats)]
        if simulate:
            _simulate(model, wanted, out, effects, seed)
        else:
            _on_graph(model, wanted, out, say, domain)
    data = {"case": str(out), "runs": len(wanted)}
    echo_result(as_json, data, f"{len(wanted)} runs in {out}; next: sher3 gap diagnose {out}")


def _simulate(robot: Robot, wanted: list[tuple[Excitation, int]], out: Path, effects: Path | None, seed: int) -> None:
    from sher3_bags import write_case
    from sher3_effects import load_effects
    from sher3_gap.experiments.rehearsal import rehearse

    given = load_effects(effects) if effects else []
    write_case(out, rehearse(robot, wanted, given, seed=seed), robot)


def _on_graph(robot: Robot, wanted: list[tuple[Excitation, int]], out: Path, say: Say, domain: int) -> None:
    from sher3_gap.excitation.excite_node import excite_graph

    excite_graph(robot, wanted, out, say, domain)
