"""`sher3 demo`: a scripted surgeon on mocks, recorded, computed again, analysed, drawn."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

from sher3_common import Sher3Error, read_json
from sher3_common.progress import Say, silent
from sher3_control.motion.speed_cap import Regime
from sher3_runtime.ports import STATISTICS_VARIABLE

from sher3_bringup.errors import ConfigurationError
from sher3_bringup.processes.up import run_graph
from sher3_bringup.settings.patience import Patience
from sher3_bringup.settings.run_settings import RunSettings, checked, parse_processes
from sher3_bringup.surgeon.script import Script, demo_script, load_script

DOMAIN = 73
"""ROS domain of the demo: not the default one, so that it does not meet a robot that is running."""
NEWEST = "demo"
"""Name of the link to the newest recording of a demo, beside it."""
AFTERWARDS = 0.4
"""Seconds for which the graph runs on after the script."""


def run_demo(
    rate: float,
    effects: Path | None,
    script_path: Path | None,
    folder: Path,
    say: Say = print,
    patience: Patience = "patient",
    domain: int = DOMAIN,
    status: Say = silent,
) -> dict[str, Any]:
    """Run the demo and return its figures as plain data.

    Raises:
        SessionFailed: the robot faulted (EndedInFault), was not enabled or did not move; the figures are there.
        Sher3Error: a bad option or file, or a part that failed; see `up`.
    """
    script = load_script(script_path or demo_script())
    if not os.access(folder if folder.exists() else folder.parent, os.W_OK):
        raise ConfigurationError(f"{folder} cannot be written", remedy="name another --folder")
    bag = folder / f"demo_{datetime.now():%Y%m%d_%H%M%S}"
    settings = checked(
        rate=rate,
        effects=effects,
        record=bag,
        processes=parse_processes(None, mock=True, record=True),
        duration=script.duration + AFTERWARDS,
        domain=domain,
        realtime=-1,
        patience=patience,
    )
    if patience == "patient":
        farthest = max(row.travel for row in settings.budget().of(Regime.FREE))
        say(f"patient time limits, for mocks alone: no travel guarantee (up to {farthest * 1e3:.1f} mm after a fault)")
    statistics = bag.parent / f".{bag.name}.statistics"
    os.environ[STATISTICS_VARIABLE] = str(statistics)
    try:
        run_graph(settings, say, {"teleop": lambda: [_surgeon(script)]}, _Progress(script, say), status)
        nodes = {path.stem: read_json(path)["statistics"] for path in sorted(statistics.glob("*.json"))}
    finally:
        shutil.rmtree(statistics, ignore_errors=True)
    return _evaluate(settings, script, bag, nodes, say)


def _surgeon(script: Script) -> Any:
    from sher3_bringup.surgeon.teleop_node import script_node

    return script_node(script)


class _Progress:
    """Says each step of the script as it begins."""

    def __init__(self, script: Script, say: Say) -> None:
        self._script, self._say = script, say
        self._step = -1

    def __call__(self, elapsed: float) -> None:
        step, _ = self._script.step_at(elapsed)
        if step != self._step and elapsed < self._script.duration:
            self._step = step
            self._say(f"  {elapsed:5.1f} s of {self._script.duration:.1f} s  {self._script.steps[step].name}")


def _evaluate(
    settings: RunSettings, script: Script, bag: Path, nodes: dict[str, dict[str, Any]], say: Say
) -> dict[str, Any]:
    from sher3_bags.figures.analysis import analyse
    from sher3_bags.figures.picture import draw
    from sher3_bags.figures.report import Block, analysis_text
    from sher3_bags.reading import read_run
    from sher3_control.replay import replay_admittance, replay_motion
    from sher3_view.figures import write_figures

    from sher3_bringup.demo.node_timing import node_timing
    from sher3_bringup.demo.verdict import judge

    robot = settings.robot()
    _link(bag)
    say("analysing the recording")
    run = read_run(bag, check=False)
    analysis = analyse(run, robot)
    picture = draw(run, analysis, bag / "summary.png")
    again = {
        "servo_cv": _computed_again(replay_admittance, run, robot),
        "servo_jv": _computed_again(replay_motion, run, robot),
    }
    more = [
        node_timing(nodes),
        *(Block(f"{topic} computed again: {_outcome(found)}") for topic, found in again.items()),
    ]
    page = write_figures(run, analysis, bag / "summary.html", robot, more)
    say("\n" + "\n\n".join([analysis_text(analysis), *map(str, more)]))
    say(f"\nbag      {bag}, also {bag.parent / NEWEST}\npicture  {picture}")
    say(f"page     {page}  (figures, and the robot in motion; for a browser)")
    judge(run, script, int(run["mock/pedal"].stamp[0]))
    say("the robot was enabled, moved in every step that asked for it and did not stop by itself")
    return {
        "bag": str(bag),
        "picture": str(picture),
        "page": str(page),
        "rate": settings.rate,
        "analysis": analysis.to_dict(),
        "nodes": nodes,
        "computed_again": again,
    }


def _link(bag: Path) -> None:
    """Let `demo` beside a recording lead to it; a folder of that name that is none of ours stays."""
    link, new = bag.parent / NEWEST, bag.parent / f".{bag.name}.link"
    if link.is_symlink() or not link.exists():
        new.symlink_to(bag.name)
        new.replace(link)


def _computed_again(replay: Callable[[Any, Any], Any], run: Any, robot: Any) -> dict[str, Any]:
    """Return the outcome of a replay; a machine too busy to record every sample leaves nothing to compare with."""
    try:
        return dict(vars(replay(run, robot)))
    except Sher3Error as error:
        return {"error": str(error)}


def _outcome(found: dict[str, Any]) -> str:
    return found.get("error") or f"{found['compared']} commands, {found['different']} differ"
