"""The commands of this package: `up`, `teleop`, `demo`."""

from __future__ import annotations

import gc
import json
import sys
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer
from sher3_common.commands.options import Domain, InNamespace, Json
from sher3_common.namespace import NAMESPACE

if TYPE_CHECKING:
    from sher3_bringup.terminal.screen import Screen

app = typer.Typer(rich_markup_mode="markdown")

Robot = Annotated[Optional[Path], typer.Option(help="Robot file; the nominal robot by default.")]  # noqa: UP045


class Layout(str, Enum):
    """Which nodes share a process."""

    SEPARATE = "separate"
    COMPOSED = "composed"


@app.command(
    epilog="Examples: `sher3 up` · `sher3 up --rate 1000 --record bags/run` · "
    "`sher3 up --rate 1000 --layout composed` · `sher3 up --effects backlash.yaml` · `sher3 up --without pedal` · "
    "`sher3 up --nodes force_sensor+pedal,admittance+kinematics,motor_driver,plant,supervisor` · "
    "`sher3 up --real --can socketcan:can0 --can socketcan:can1`"
)
def up(
    mock: Annotated[
        bool, typer.Option("--mock/--real", help="Emulated drives, sensor and pedal, or the hardware.")
    ] = True,
    rate: Annotated[float, typer.Option(help="Control rate [Hz].")] = 500.0,
    nodes: Annotated[
        str, typer.Option(help="Nodes to run: `,` between processes, `+` within one; all by default.")
    ] = "",
    without: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(help="Leave this node out: pedal or force_sensor where you publish its topic yourself."),
    ] = None,
    layout: Annotated[
        Layout, typer.Option(help="Processes: one for each node, or one for the loop (half the processor time).")
    ] = Layout.SEPARATE,
    effects: Annotated[Optional[Path], typer.Option(help="Effects for the plant (YAML, sher3.effects/1).")] = None,  # noqa: UP045
    record: Annotated[Optional[Path], typer.Option(help="Record the run into this new folder.")] = None,  # noqa: UP045
    record_optional: Annotated[
        bool,
        typer.Option("--record-optional", help="Go on when the recorder dies or the disk is full; else stop."),
    ] = False,
    monitor: Annotated[
        bool,
        typer.Option("--monitor", help="Also run the gap monitor: gap/diagnostics at 1 Hz against the nominal model."),
    ] = False,
    patient: Annotated[
        Optional[bool],  # noqa: UP045
        typer.Option(
            "--patient/--strict",
            help="Time limits that a held-up process does not trip, for mocks, or those of the robot; patient by "
            "default on the bench without real-time rights.",
        ),
    ] = None,
    duration: Annotated[Optional[float], typer.Option(help="Stop after so many seconds.")] = None,  # noqa: UP045
    robot: Robot = None,
    drives: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Name plates of the drives (YAML, sher3.drives/1); the robot does not start with others."),
    ] = None,
    can: Annotated[Optional[list[str]], typer.Option(help="CAN link of each channel, as socketcan:can0.")] = None,  # noqa: UP045
    force_device: Annotated[str, typer.Option(help="Device of the force sensor (real robot).")] = "",
    pedal_device: Annotated[str, typer.Option(help="Device of the pedal (real robot).")] = "",
    realtime: Annotated[
        int, typer.Option(help="SCHED_FIFO priority, 0 for none; -1: 40 where permitted.", min=-1, max=90)
    ] = -1,
    seed: Annotated[int, typer.Option(help="Seed of the plant's noise.")] = 0,
    regime: Annotated[
        str, typer.Option(help="Speed regime: near_tissue, free or bench; bench on mocks, free on the robot.")
    ] = "",
    near_speed: Annotated[Optional[float], typer.Option(help="Speed cap near tissue [m/s].")] = None,  # noqa: UP045
    free_speed: Annotated[Optional[float], typer.Option(help="Speed cap elsewhere [m/s].")] = None,  # noqa: UP045
    view: Annotated[bool, typer.Option("--view", help="Also show the robot in the browser (extra `view`).")] = False,
    view_port: Annotated[int, typer.Option(help="Port of the view, on 127.0.0.1 alone.", min=1, max=65535)] = 8080,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
    other_hosts: Annotated[
        bool, typer.Option("--other-hosts", help="Also talk to other machines; loopback by default.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Start the robot and keep it running until Ctrl-C.

    Every node is a process of its own unless `--layout composed` or `--nodes` joins some. A line says when
    all are ready, and one more each change of state with its reason and remedy; on a terminal a line below them tells
    state, mode, force, speed and lost cycles. If a process ends, everything is stopped, drives first.

    Exit codes: 0 stopped as asked, 2 a wrong option or file, 3 not started (a device is missing), 4 a process died,
    5 a process had to be killed, 6 the robot was in FAULT at the end.
    """
    gc.disable()  # nothing that is imported until the processes are forked is garbage; `preload` enables it again
    from sher3_bringup.errors import EndedInFault
    from sher3_bringup.processes.onlooker import onlooker
    from sher3_bringup.processes.up import granted, run_graph
    from sher3_bringup.settings.patience import usual
    from sher3_bringup.settings.run_settings import checked, parse_processes

    patience = usual(mock, regime, granted(realtime)) if patient is None else "patient" if patient else "strict"
    settings = checked(
        mock=mock,
        rate=rate,
        processes=parse_processes(nodes, mock, record is not None, monitor, layout.value, without or ()),
        robot_path=robot,
        drives_path=drives,
        effects=effects,
        exchange=view and mock,
        record=record,
        recording="optional" if record_optional else "required",
        duration=duration,
        links=tuple(can or ()),
        force_device=force_device,
        pedal_device=pedal_device,
        realtime=realtime,
        seed=seed,
        patience=patience,
        regime=regime,
        near_speed=near_speed,
        free_speed=free_speed,
        domain=domain,
        other_hosts=other_hosts,
    )
    screen = _screen(as_json)
    if patient is None and patience == "patient":
        screen("no real-time rights: patient time limits, for mocks alone; --strict has those of the robot")
    with onlooker(view, domain, view_port):
        fault = run_graph(settings, say=screen, status=screen.status)
    if fault:
        raise EndedInFault(fault)


@app.command(
    epilog="Examples: `sher3 teleop` (keyboard) · `sher3 teleop surgeon.yaml` · `sher3 teleop --print > surgeon.yaml`"
)
def teleop(
    script: Annotated[
        Path | None, typer.Argument(help="Script (YAML, sher3.teleop/1); the keyboard without one.")
    ] = None,
    device: Annotated[
        Path | None, typer.Option(help="Joystick or SpaceMouse as hand and foot: /dev/input/js0, /dev/input/event7.")
    ] = None,
    show: Annotated[bool, typer.Option("--print", help="Print the script of the demo and leave.")] = False,
    rate: Annotated[float, typer.Option(help="Control rate of the running graph [Hz].")] = 500.0,
    domain: Domain = 0,
    namespace: InNamespace = NAMESPACE,
) -> None:
    """Act the surgeon on a running mock: press the pedal and push the tool.

    At the keyboard the robot answers: state with its reason, tip, speed, force, pedal, and what it refused. A script
    prints its steps, and each change of state with its reason and remedy.

    Exit codes of a script: 3 no robot was heard, 6 the robot was in FAULT at the end.
    """
    from sher3_bringup.surgeon.script import demo_script, load_script

    if show:
        typer.echo(demo_script().read_text(), nl=False)
        return
    from sher3_bringup.surgeon.teleop import run_keyboard, run_script

    if script is None:
        run_keyboard(rate, domain, device)
    else:
        run_script(load_script(script), rate, domain)


@app.command(epilog="Examples: `sher3 demo` · `sher3 demo --rate 1000` · `sher3 demo --effects backlash.yaml --json`")
def demo(
    rate: Annotated[float, typer.Option(help="Control rate [Hz].")] = 500.0,
    effects: Annotated[Optional[Path], typer.Option(help="Effects for the plant.")] = None,  # noqa: UP045
    script: Annotated[Optional[Path], typer.Option(help="Script of the surgeon.")] = None,  # noqa: UP045
    folder: Annotated[Path, typer.Option(help="Where the run's folder is made.")] = Path("bags"),
    view: Annotated[bool, typer.Option("--view", help="Also show the robot in the browser (extra `view`).")] = False,
    view_port: Annotated[int, typer.Option(help="Port of the view, on 127.0.0.1 alone.", min=1, max=65535)] = 8080,
    domain: Domain = 73,
    namespace: InNamespace = NAMESPACE,
    as_json: Json = False,
) -> None:
    """Run every node on mocks with a scripted surgeon, record it, analyse the recording, show figures and a picture."""
    from sher3_bringup.demo.session import run_demo
    from sher3_bringup.processes.onlooker import onlooker

    screen = _screen(as_json)
    with onlooker(view, domain, view_port):
        result = run_demo(rate, effects, script, folder, say=screen, domain=domain, status=screen.status)
    if as_json:
        typer.echo(json.dumps(result))


def _screen(quiet: bool) -> Screen:
    """Return what prints progress: to standard error when standard output carries JSON."""
    from sher3_bringup.terminal.screen import Screen

    return Screen(sys.stderr if quiet else sys.stdout)
