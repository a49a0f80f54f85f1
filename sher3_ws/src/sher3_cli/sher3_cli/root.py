"""The `sher3` command: one root, and each package's commands, imported when they are asked for."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import Annotated, NamedTuple

import typer
from sher3_common import Sher3Error
from sher3_common.commands.options import BAD_INPUT

from sher3_cli.completion import completed_words


class Entry(NamedTuple):
    """Where a command lives: the Typer `app` of `module`, and its name there (empty: the app is a group)."""

    module: str
    command: str
    help: str


COMMANDS: dict[str, Entry] = {
    "up": Entry("sher3_bringup.cli", "up", "Start the robot: every node, on mocks or on the hardware."),
    "teleop": Entry("sher3_bringup.cli", "teleop", "Act the surgeon on a running mock: a script or the keyboard."),
    "demo": Entry("sher3_bringup.cli", "demo", "Run a scripted surgeon on mocks, record, analyse, show."),
    "completion": Entry("sher3_cli.completion", "completion", "Print the completion script of a shell."),
    "fk": Entry("sher3_kinematics.cli", "fk", "Tip pose from actuator positions."),
    "ik": Entry("sher3_kinematics.cli", "ik", "Actuator positions from a tip pose."),
    "record": Entry("sher3_bags.cli", "record", "Record the running graph into a bag."),
    "replay": Entry("sher3_bags.cli", "replay", "Play a bag into the graph, at any rate."),
    "analyze": Entry("sher3_view.cli", "analyze", "Figures and a picture of a bag."),
    "compare": Entry("sher3_bags.cli", "compare", "Differences of two bags, on header time."),
    "recover": Entry("sher3_bags.cli", "recover", "Save what can be read of a cut bag."),
    "info": Entry("sher3_bags.cli", "info", "What a bag holds."),
    "view": Entry("sher3_view.cli", "view", "Show a recording or the running robot in three dimensions."),
    "state": Entry("sher3_view.cli", "state", "Publish the running robot for RViz and other ROS tools."),
    "foxglove": Entry("sher3_view.cli", "foxglove", "Serve the running robot to Foxglove."),
    "gap": Entry("sher3_gap_cli.app", "", "Find and explain the gap between a robot and its simulation."),
    "design": Entry("sher3_paper.cli", "design", "Recompute the design of the robot."),
    "paper": Entry("sher3_paper.cli", "paper", "Recompute the figures and tables of the paper."),
    "safety": Entry("sher3_safety.cli.safety", "", "Break everything in turn; measure stops and travel."),
    "fault": Entry("sher3_safety.cli.fault", "fault", "Break one part of the running robot on mocks."),
    "benchtop": Entry("sher3_benchtop.cli", "benchtop", "The bench-top tests of the paper, on the running graph."),
}
EXTRAS = {
    **dict.fromkeys(("rclpy", "rcl_interfaces", "can", "canopen", "pinocchio"), "robot"),
    **dict.fromkeys(("mcap", "rosbags", "zstandard", "lz4"), "bags"),
    "distributed": "cluster",
}
"""The extra that brings a library; message packages come with `robot`."""


class UnknownCommand(Sher3Error):
    """There is no such command of `sher3`."""

    exit_code = 2

    def __init__(self, name: str) -> None:
        near = get_close_matches(name, COMMANDS, 1, cutoff=0.5)
        remedy = f"did you mean {near[0]}?" if near else "`sher3 --help` lists them"
        super().__init__("no such command", value=name, remedy=remedy)


class NotInstalled(Sher3Error):
    """A command needs a library of an extra that is not installed."""

    exit_code = 2

    def __init__(self, library: str, extra: str) -> None:
        remedy = f"pip install 'sher3[{extra}]'" + (", or source a ROS 2 Jazzy" if extra == "robot" else "")
        super().__init__(f"needs the libraries of the extra {extra}", value=f"no {library}", remedy=remedy)


def make_app(chosen: str | None = None, completing: bool = False) -> typer.Typer:
    """Return the root with command `chosen` imported and the others as mere names; all of them for `"*"`.

    `completing`: a shell asks what to offer; only then Typer knows the shells, and only then it has options that write
    into the user's files.
    """
    root = typer.Typer(
        name="sher3",
        help="The Steady-Hand Eye Robot 3.0: run it, record it, explain it. `sher3 COMMAND --help` shows examples.",
        no_args_is_help=True,
        add_completion=completing,
        rich_markup_mode="markdown",
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    root.callback()(_root)
    for name, entry in COMMANDS.items():
        if chosen in (name, "*"):
            _mount(root, name, entry)
        else:
            root.command(name, help=entry.help)(_stub)
    return root


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; every failure is one sentence and an exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    completing = completed_words()
    chosen = next((word for word in completing or words if not word.startswith("-")), None)
    try:
        if chosen is not None and chosen not in COMMANDS and completing is None:
            raise UnknownCommand(chosen)
        make_app(chosen, completing is not None)(args=words, prog_name="sher3")
    except Sher3Error as error:
        print(f"sher3: {error}", file=sys.stderr)
        sys.exit(getattr(error, "exit_code", BAD_INPUT))
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        extra = "robot" if library.endswith("_msgs") else EXTRAS.get(library)
        if extra is None:
            raise
        print(f"sher3: {NotInstalled(library, extra)}", file=sys.stderr)
        sys.exit(NotInstalled.exit_code)
    except BrokenPipeError:
        # The reader of our output has gone; there is nobody to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"sher3: {where}{error.strerror or error}", file=sys.stderr)
        sys.exit(1)


def _mount(root: typer.Typer, name: str, entry: Entry) -> None:
    app = import_module(entry.module).app
    if not entry.command:
        root.add_typer(app, name=name, help=entry.help)
        return
    for info in app.registered_commands:
        if (info.name or getattr(info.callback, "__name__", "")) == entry.command:
            root.registered_commands.append(info)
            info.name = name
            return
    raise LookupError(f"{entry.module} has no command {entry.command}")


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Keep the root a group even when a single command is imported."""


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"sher3 {version('sher3')}")
        raise typer.Exit


def _stub() -> None:
    """Stand for a command in the list of commands."""
