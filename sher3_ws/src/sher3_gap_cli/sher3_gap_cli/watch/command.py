"""`sher3 gap watch`: a running robot held against its model, whatever drives it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sher3_gap_cli.options import reported

if TYPE_CHECKING:
    from sher3_gap_cli.watch.judged import Status


class Kind(str, Enum):
    """Types of a command topic."""

    joint_state = "JointState"
    array = "Float64MultiArray"
    trajectory = "JointTrajectory"


def watch(
    model: Annotated[Path, typer.Option(help="URDF or MJCF of the robot.")],
    states: Annotated[str, typer.Option(help="Topic of the joint states.")] = "/joint_states",
    command: Annotated[str, typer.Option(help="Topic of the command; default: none is heard.")] = "",
    kind: Annotated[
        Kind, typer.Option(help="Type of the command; an array has the order of --joint.")
    ] = Kind.joint_state,
    joint: Annotated[
        list[str] | None, typer.Option(help="Joint of the model to watch; repeat for more. Default: all.")
    ] = None,
    window: Annotated[float, typer.Option(min=2.0, help="Seconds that are diagnosed at a time.")] = 20.0,
    every: Annotated[float, typer.Option(min=1.0, help="Seconds from one diagnosis to the next.")] = 60.0,
    rate: Annotated[float, typer.Option(min=10.0, help="Samples per second that are kept, Hz.")] = 100.0,
    best_effort: Annotated[
        bool, typer.Option("--best-effort", help="Subscribe as sensors publish: best effort, nothing is sent twice.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object for each diagnosis.")] = False,
) -> None:
    """Diagnose a running robot again and again, and publish its causes on /diagnostics at 1 Hz, until Ctrl-C.

    Needs the extra `robot`. The graph is that of ROS_DOMAIN_ID. Exit codes: 0 ended by Ctrl-C, 2 the model is wrong.
    """
    from sher3_public.errors import InputError
    from sher3_public.models import source_of

    from sher3_gap_cli.watch.watch_node import WatchNode, run
    from sher3_gap_cli.watch.window import Window

    with reported(as_json):
        source = source_of(model)
        known = list(source.bodies.joints)
        if strange := [name for name in joint or () if name not in known]:
            raise InputError.unknown("--joint: the model has no such joint", strange[0], known)
        kept = Window(joint or known, window, rate)
        text = source.text or ""
        topics = (states, command, kind.value, not best_effort)
        run(lambda: WatchNode(text, kept, every, *topics, print_json if as_json else print_statuses))


def print_statuses(found: Sequence[Status]) -> None:
    """Print what a diagnosis found."""
    for status in found:
        print(f"{status.name}: {status.message}", flush=True)


def print_json(found: Sequence[Status]) -> None:
    """Print what a diagnosis found as one line of JSON."""
    print(
        json.dumps({"statuses": [{**status._asdict(), "values": dict(status.values)} for status in found]}), flush=True
    )
