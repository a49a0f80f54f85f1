"""`sher3 gap monitor`: the model beside the running robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from sher3_common.commands.options import Domain, InNamespace
from sher3_common.namespace import NAMESPACE

from sher3_gap_cli.options import NominalFile, reported


def monitor(
    effects: Annotated[Path | None, typer.Option(help="Effects of the model; nominal without.")] = None,
    window: Annotated[float, typer.Option(min=0.5, max=60.0, help="Seconds a gap is taken over.")] = 4.0,
    robot: NominalFile = None,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    as_json: Annotated[bool, typer.Option("--json", help="Also print one JSON object a second.")] = False,
) -> None:
    """Run the model beside the running robot; gap over floor per stage on gap/diagnostics at 1 Hz, until Ctrl-C."""
    from sher3_description import load_robot
    from sher3_effects import load_effects
    from sher3_gap.live.gap_monitor_node import Named, StageStatus, judged_json, run

    def say(stamp: int, found: list[StageStatus], named: Named | None) -> None:
        print(judged_json(stamp, found, named), flush=True)

    with reported(as_json):
        run(load_robot(robot), load_effects(effects) if effects else [], window, domain, say if as_json else None)
