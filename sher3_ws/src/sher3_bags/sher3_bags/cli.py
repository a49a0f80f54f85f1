"""The bag commands of `sher3`: record, replay, compare, recover, info."""

from __future__ import annotations

import json
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from sher3_common.commands.completing import BAG, CASE, folders_with
from sher3_common.commands.options import Domain, InNamespace, Json, reported
from sher3_description.topics import NAMESPACE

app = typer.Typer(no_args_is_help=True, help="Record, replay, compare and recover bags.")

Bag = Annotated[Path, typer.Argument(help="Bag folder or .mcap file.", autocompletion=folders_with(BAG))]
Topics = Annotated[list[str] | None, typer.Option("--topic", help="Topic relative to /sher3; repeat for more.")]
Namespace = Annotated[str, typer.Option(help="Namespace of the robot in the bag.")]


def printed(as_json: bool, data: dict[str, Any], text: str) -> None:
    """Print figures as one JSON object or as text."""
    typer.echo(json.dumps(data) if as_json else text)


@app.command(epilog="Example: sher3 record bags/trial --seconds 20")
def record(
    output: Annotated[Path | None, typer.Argument(help="New folder; default bags/<date and time>.")] = None,
    seconds: Annotated[float | None, typer.Option(help="End this long after the first sample; else at Ctrl-C.")] = None,
    topic: Topics = None,
    robot: Annotated[Path | None, typer.Option(help="robot.yaml to attach; default the nominal one.")] = None,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    as_json: Json = False,
) -> None:
    """Record the running graph into a new bag; exit code 1 where no message came."""
    from shutil import rmtree

    from sher3_description import load_robot

    from sher3_bags.errors import NothingRecorded
    from sher3_bags.recording.recorder_node import run

    with reported(as_json):
        target = output or Path("bags", datetime.now().strftime("%Y%m%d_%H%M%S"))
        typer.echo(f"recording to {target}, Ctrl-C stops", err=True)
        counts = run(target, load_robot(robot), topics=topic, seconds=seconds, domain=domain)
        if not any(entry["messages"] for name, entry in counts.items() if name != "diagnostics"):
            remedy = f"start the robot in ROS domain {domain}, or name its domain"
            rmtree(target)
            raise NothingRecorded("no message of the robot came, and no bag is kept", path=target, remedy=remedy)
        lines = [f"{name}: {entry['messages']} messages, {entry['dropped']} missing" for name, entry in counts.items()]
        printed(as_json, {"bag": str(target), "topics": counts}, "\n".join([*lines, f"recorded to {target}"]))


@app.command(epilog="Example: sher3 replay bags/trial --rate 0.5 --topic force/measured_cf --topic pedal/measured")
def replay(
    bag: Bag,
    rate: Annotated[
        float,
        typer.Option(
            help="Speed; 2 is twice as fast (up to 50 messages of a topic per tick), inf as fast as no queue overflows."
        ),
    ] = 1.0,
    topic: Topics = None,
    keep_stamps: Annotated[bool, typer.Option("--keep-stamps", help="Leave header stamps as recorded.")] = False,
    wait_for: Annotated[int, typer.Option(help="Subscribers to wait for on every topic.")] = 0,
    namespace: Namespace = NAMESPACE,
    domain: Domain = 0,
    as_json: Json = False,
) -> None:
    """Publish the messages of a bag into the graph, on topics nobody else publishes."""
    from sher3_bags.playback.replay import Replay
    from sher3_bags.playback.replay_node import run

    with reported(as_json):
        player = Replay(bag, topic, rate=rate, stamps="keep" if keep_stamps else "shift", namespace=namespace)
        typer.echo(f"replaying {len(player)} messages in {player.duration:.1f} s", err=True)
        sent = run(player, wait_for, domain)
        data = {"bag": str(bag), "sent": sent, "messages": len(player), "topics": list(player.topics)}
        printed(as_json, data, f"sent {sent} of {len(player)} messages of {len(player.topics)} topics")


@app.command(epilog="Example: sher3 compare bags/before bags/after --topic measured_cp --picture difference.png")
def compare(
    a: Annotated[Path, typer.Argument(help="Reference bag.", autocompletion=folders_with(BAG))],
    b: Annotated[Path, typer.Argument(help="Other bag.", autocompletion=folders_with(BAG))],
    picture: Annotated[Path | None, typer.Option(help="Also draw the differences to this PNG, PDF or SVG.")] = None,
    align: Annotated[str, typer.Option(help="auto, stamp (one clock) or start (both from zero).")] = "auto",
    topic: Topics = None,
    as_json: Json = False,
) -> None:
    """Difference of two runs on header time: lag and residuals per topic and axis."""
    from sher3_bags.figures.compare import alignment_from
    from sher3_bags.figures.compare import compare as compare_runs
    from sher3_bags.figures.report import comparison_text
    from sher3_bags.reading import read_run

    with reported(as_json):
        alignment = alignment_from(align)
        one, two = read_run(a, topic), read_run(b, topic)
        result = compare_runs(one, two, alignment=alignment, topics=topic)
        data, note = result.to_dict(), ""
        if picture is not None:
            from sher3_bags.figures.compare_picture import draw_comparison

            data["picture"] = str(draw_comparison(one, two, result, picture))
            note = f"\n\npicture: {picture}"
        printed(as_json, data, comparison_text(result) + note)


@app.command(epilog="Example: sher3 recover bags/trial --output bags/trial_whole")
def recover(
    bag: Bag,
    output: Annotated[Path | None, typer.Option(help="New folder; default <bag>_recovered.")] = None,
    as_json: Json = False,
) -> None:
    """Save what can be read of a cut or corrupt bag, and count what cannot."""
    from sher3_bags.recovery import recover as recover_bag

    with reported(as_json):
        recovery = recover_bag(bag, output)
        printed(as_json, asdict(recovery), str(recovery))


@app.command(epilog="Example: sher3 info bags/trial")
def info(bag: Bag, namespace: Namespace = NAMESPACE, as_json: Json = False) -> None:
    """Show what a bag or a case holds: topics, metadata, provenance, samples the recorder missed; runs of a case."""
    from sher3_bags.figures.overview import case_overview, case_text, overview, overview_text

    with reported(as_json):
        if (bag / CASE).is_file():
            runs = case_overview(bag)
            printed(as_json, runs, case_text(runs))
            return
        data = overview(bag, namespace)
        printed(as_json, data, overview_text(data))
