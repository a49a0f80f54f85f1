"""One node as a program of its own, for launch files: `supervisor --rate 500 --ros-args -r __ns:=/left`.

The name of the program is the node. `sher3 up` is the way to run a robot: it starts all processes at one tick, watches
them and stops them together. A launch file does none of this; the robot's own supervision holds all the same.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from sher3_common import Sher3Error
from sher3_common.namespace import use_namespace
from sher3_runtime import environment

NAMESPACE_RULE = "__ns:="
"""ROS's own rule; it would move the node alone, since topics have absolute names, so that it is obeyed here."""


def main() -> None:
    """Run the node that this program is named after until a signal; an error is one sentence and exit code 3."""
    try:
        run_one(Path(sys.argv[0]).name, sys.argv[1:])
    except Sher3Error as error:
        print(f"sher3: {error}", file=sys.stderr)
        sys.exit(3)


def run_one(name: str, words: Sequence[str]) -> None:
    """Run one node with the words of its command line.

    Raises:
        ConfigurationError: an option is wrong. Sher3Error: the node does not start, a device is missing for instance.
    """
    ours, theirs = split(words)
    if asked := [word.removeprefix(NAMESPACE_RULE) for word in theirs if word.startswith(NAMESPACE_RULE)]:
        use_namespace(asked[-1])
    wanted = _parser(name).parse_args(ours)
    environment.apply(wanted.domain, wanted.other_hosts)
    from sher3_runtime.ports import NODE_OPTIONS, PERIOD_VARIABLE
    from sher3_runtime.process import run

    from sher3_bringup.processes.nodes import make_nodes, preload
    from sher3_bringup.settings.run_settings import checked

    os.environ[PERIOD_VARIABLE] = repr(1.0 / wanted.rate)
    settings = checked(
        mock=not wanted.real,
        rate=wanted.rate,
        processes=((name,),),
        robot_path=wanted.robot,
        effects=wanted.effects,
        record=wanted.record,
        links=tuple(wanted.can),
        force_device=wanted.force_device,
        pedal_device=wanted.pedal_device,
        patience="patient" if wanted.patient else "strict",
        regime=wanted.regime,
        domain=wanted.domain,
    )
    preload(settings, [name])
    # Remap rules are arguments of the process; the nodes of `sher3 up` have none.
    NODE_OPTIONS["use_global_arguments"] = True
    sys.argv = [name, *theirs]
    run(lambda: make_nodes(settings, [name]))


def split(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return our options, and those of ROS."""
    at = list(words).index("--ros-args") if "--ros-args" in words else len(words)
    return list(words[:at]), list(words[at:])


def _parser(name: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=name, description=f"The node {name} of the SHER 3.0; see `sher3 up --help`.")
    parser.add_argument("--rate", type=float, default=500.0, help="control rate [Hz], the same for all nodes")
    parser.add_argument("--real", action="store_true", help="the hardware instead of mocks")
    parser.add_argument("--patient", action="store_true", help="time limits for a busy machine; mocks alone")
    parser.add_argument("--robot", type=Path, help="robot file")
    parser.add_argument("--effects", type=Path, help="effects for the plant")
    parser.add_argument("--record", type=Path, help="folder of the recorder")
    parser.add_argument("--can", action="append", default=[], help="CAN link, once for each channel")
    parser.add_argument("--force-device", default="", help="address of the force sensor")
    parser.add_argument("--pedal-device", default="", help="device of the pedal")
    parser.add_argument("--regime", default="", help="speed regime at the start")
    parser.add_argument("--domain", type=int, default=int(os.environ.get("ROS_DOMAIN_ID") or 0), help="ROS domain id")
    parser.add_argument("--other-hosts", action="store_true", help="talk to other machines")
    return parser
