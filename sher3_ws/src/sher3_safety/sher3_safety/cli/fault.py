"""Command `fault`: one fault into a running robot on mocks."""

from __future__ import annotations

import json
from typing import Annotated, Any, Optional

import typer
from sher3_bringup.errors import ConfigurationError
from sher3_common.commands.options import Domain, InNamespace
from sher3_common.namespace import NAMESPACE

app = typer.Typer(rich_markup_mode="markdown")


@app.command(
    epilog="Examples: `sher3 fault force_sensor stuck --for 0.5` · "
    "`sher3 fault roll.load_encoder wrong -p offset=0.001` · "
    "`sher3 fault bus0.up delayed -p delay=0.01 --for 1` · `sher3 fault all ok`"
)
def fault(
    component: Annotated[str, typer.Argument(help="What breaks: force_sensor, pedal, bus, delta_1, roll.demand, ...")],
    kind: Annotated[str, typer.Argument(help="off, stuck, garbage, wrong, slow, delayed, ...; ok ends it.")],
    seconds: Annotated[Optional[float], typer.Option("--for", help="Seconds it lasts; until ok by default.")] = None,  # noqa: UP045
    start: Annotated[float, typer.Option(help="Seconds from now.")] = 0.0,
    parameter: Annotated[Optional[list[str]], typer.Option("-p", "--parameter", help="NAME=VALUE of the kind.")] = None,  # noqa: UP045
    seed: Annotated[int, typer.Option(help="Seed of what is random in it.", min=0)] = 0,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Break a part of the running robot on mocks (`sher3 up`).

    Exit codes: 2 no such component, fault or parameter; 3 no robot on mocks is running.
    """
    from sher3_faults.requests import make_request

    request = make_request(
        component=component, fault=kind, start=start, duration=seconds, seed=seed, parameters=_numbers(parameter or [])
    )
    from sher3_safety.runs.fault_node import inject

    answer = inject(request, domain)
    typer.echo(json.dumps({"request": request.model_dump(), "answer": answer}) if as_json else answer)


def _numbers(texts: list[str]) -> dict[str, Any]:
    numbers = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            numbers[name] = float(value)
        except ValueError:
            raise ConfigurationError("parameter", value=text, remedy="write NAME=NUMBER") from None
    return numbers
