"""What commands find in their folder: recordings, cases, effects, scripts, each made once a session."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import yaml
from documentation.commands import Command
from documentation.terminal import Terminal

EFFECTS = (
    "schema: sher3.effects/1\neffects:\n  - {{effect: backlash, actuator: tilt, parameters: {{width: {width}}}}}\n"
)
SURGEON = """schema: sher3.teleop/1
steps:
  - {name: settle, duration: 0.5}
  - {name: enable, duration: 0.5, command: enable}
  - {name: push, duration: 1.0, pedal: 1.0, wrench: [1.0, 0, 0, 0, 0, 0], ramp: 0.3}
  - {name: leave, duration: 0.3}
"""
OUTPUT = r"(?:-o|--out|--output|--record|--markdown|>>?|file:|sher3 record)\s+"
"""What stands before a name that a command writes."""


class Inputs:
    """Makes inputs by name, once each, and copies them into working folders.

    Args:
        store: where they are kept.
        terminal: opens a terminal in a folder, to make those that a command makes.
    """

    def __init__(self, store: Path, terminal: Callable[[Path], Terminal]) -> None:
        self.store, self.terminal = store, terminal
        self.makers: dict[str, Callable[[Path], None]] = {
            "backlash.yaml": lambda path: _text(path, EFFECTS.format(width="60.0e-6")),
            "corrected.yaml": lambda path: _text(path, EFFECTS.format(width="59.0e-6")),
            "surgeon.yaml": lambda path: _text(path, SURGEON),
            "my.yaml": lambda path: _text(path, SURGEON),
            "bags/trial": lambda path: _bag(path, seed=1),
            "bags/before": lambda path: _bag(path, seed=2),
            "bags/after": lambda path: _bag(path, seed=3),
            "bags/case": _case,
            "bags/session": _session,
            "bags/demo": lambda path: shutil.copytree(self.get("bags/session"), path),
            "case_001": lambda path: self._shell(
                path, "sher3 gap excite sweep,reversals --simulate -o {} --effects", EFFECTS.format(width="60.0e-6")
            ),
            "case": lambda path: shutil.copytree(self.get("case_001"), path),
            "corrected": lambda path: self._shell(
                path, "sher3 gap excite sweep,reversals --simulate -o {} --effects", EFFECTS.format(width="59.0e-6")
            ),
            "case_002": self._ambiguous,
            "gap/case_002/verdict.json": self._verdict,
            "cases": self._cases,
            "gap/case_001/verdict.json": self._verdict,
            "gap/case/verdict.json": self._verdict,
            "DATA.mat": _slide,
            "robot.xml": _two_links,
            "log.npz": log_of_two_links,
            "later.npz": lambda path: log_of_two_links(path, more=2.0),
            "run/a": lambda path: self._shell(path, "sher3 gap challenge --seeds 11200:11201 --jobs 1 --out {}"),
            "run/b": lambda path: self._shell(path, "sher3 gap challenge --seeds 11201:11202 --jobs 1 --out {}"),
        }

    def get(self, name: str) -> Path:
        """Return the stored input, made if need be."""
        path = self.store / name
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            self.makers[name](path)
        return path

    def put(self, folder: Path, text: str) -> None:
        """Copy into `folder` what the commands of `text` read and do not write themselves before."""
        for name in self.makers:
            mention = re.search(rf"(?<![\w/.]){re.escape(name)}(?![\w.-]|/verdict)", text)
            written = re.search(rf"{OUTPUT}{re.escape(name)}(?![\w.-])", text)
            if mention and not (written and written.end() <= mention.end()):
                source, target = self.get(name), folder / name
                target.parent.mkdir(parents=True, exist_ok=True)
                (shutil.copytree if source.is_dir() else shutil.copy)(source, target)

    def _shell(self, path: Path, line: str, effects: str | None = None) -> None:
        folder = path.with_name(f"{path.name}_made")
        terminal = self.terminal(folder)
        try:
            if effects is not None:
                _text(folder / "effects.yaml", effects)
                line += " effects.yaml"
            terminal.run(Command(line.format("made")))
            shutil.move(folder / "made", path)
        finally:
            terminal.close()

    def _cases(self, path: Path) -> None:
        for name in ("first", "second"):
            shutil.copytree(self.get("case_001"), path / name)

    def _ambiguous(self, path: Path) -> None:
        """Record one task of a robot whose friction yields before it slides: two kinds of friction fit it alike."""
        effect = "{effect: presliding_friction, actuator: tilt, parameters: {force: 0.5, displacement: 12.0e-6}}"
        self._shell(
            path, "sher3 gap excite task --simulate -o {} --effects", f"schema: sher3.effects/1\neffects: [{effect}]\n"
        )

    def _verdict(self, path: Path) -> None:
        """Diagnose the case of the verdict's name."""
        name = path.parent.name
        folder = path.parents[1] / f"{name}_diagnosed"
        if not folder.exists():
            terminal = self.terminal(folder)
            shutil.copytree(self.get(name), folder / name)
            terminal.run(Command(f"sher3 gap diagnose {name}"))
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(folder / "gap" / name / "verdict.json", path)


def _text(path: Path, text: str) -> None:
    path.write_text(text)


def _bag(path: Path, seed: int) -> None:
    """Write two seconds of the simulated robot as a bag."""
    from sher3_bags import write_run

    write_run(path, _run(seed))


def _case(path: Path) -> None:
    """Write a case of two repeats."""
    from sher3_bags import write_case
    from sher3_description import load_robot

    write_case(path, [_run(seed=4), _run(seed=5)], load_robot())


def _run(seed: int):
    """Return two seconds of the simulated robot, all axes moving."""
    from sher3_description import load_robot
    from sher3_sim import simulate

    robot = load_robot()
    time = np.arange(0.0, 2.0, robot.control_period)[:, None]
    reach = np.array([1e-3, 1e-3, 1e-3, 0.02, 1e-3])
    setpoints = reach * (1.0 - np.cos(2 * np.pi * 0.5 * time)) / 2
    return simulate(robot, setpoints, np.zeros((len(time), 6)), seed=seed)


def _session(path: Path) -> None:
    """Record a short session with every node, in stepped time: no sample is lost, however busy the machine is.

    Straight into its place: tests of other processes record theirs at the same time.
    """
    from robot_rig import ROBOT, RobotRig
    from sher3_bags.recording.live import recorded
    from sher3_bringup.surgeon.script import Script
    from sher3_runtime import Graph

    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        rig = RobotRig(graph)
        with recorded(graph, path.name, robot=ROBOT, root=path.parent):
            rig.play(Script.model_validate(yaml.safe_load(SURGEON)))


def _slide(path: Path) -> None:
    """Write a record with the columns of the published data set that the description `emps` is for."""
    from scipy.io import savemat

    period, mass, friction = 0.001, 95.0, 20.0
    time = np.arange(0.0, 12.0, period)
    reference = 0.08 * np.sin(2 * np.pi * 0.2 * time) + 0.02 * np.sin(2 * np.pi * 0.9 * time)
    position = velocity = 0.0
    rows = []
    for at in reference:
        volts = float(np.clip((38995.821 * (at - position) - 243.45 * 35.15 * velocity) / 35.15, -10.0, 10.0))
        rows.append((round(position, 6), volts))
        for _ in range(5):
            velocity += (35.15 * volts - friction * np.tanh(velocity / 1e-4) - 200.0 * velocity) / mass * period / 5
            position += velocity * period / 5
    q, u = np.array(rows).T
    savemat(path, {"t": time[:, None], "qg": reference[:, None], "qm": q[:, None], "vir": u[:, None]})


TWO_LINKS = """<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody><body pos="0 0 0.5">
<joint name="shoulder" axis="0 1 0" damping="0.5" frictionloss="0.3" armature="0.02"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="2"/><body pos="0.4 0 0">
<joint name="elbow" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.01"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.025" mass="1"/></body></body></worldbody>
<actuator><position joint="shoulder" kp="400" kv="20"/><position joint="elbow" kp="200" kv="8"/></actuator></mujoco>"""


def _two_links(path: Path) -> None:
    """Write the model of an arm with two position actuators."""
    path.write_text(TWO_LINKS)


def log_of_two_links(path: Path, more: float = 1.2) -> None:
    """Write ten seconds of that arm, its elbow with more dry friction, N m, than the model says."""
    import mujoco

    robot = mujoco.MjModel.from_xml_string(TWO_LINKS)
    robot.dof_frictionloss[1] += more
    state, rows = mujoco.MjData(robot), []
    for t in np.arange(5000) * 0.002:
        state.ctrl[:] = [0.6 * np.sin(1.7 * t) + 0.3 * np.sin(4.1 * t), 0.7 * np.sin(2.3 * t) + 0.2 * np.sin(5.3 * t)]
        mujoco.mj_forward(robot, state)
        rows.append([t, *state.ctrl, *state.qpos])
        mujoco.mj_step(robot, state)
    log = np.array(rows)
    position = log[:, 3:] + 1e-5 * np.random.default_rng(1).normal(size=(len(log), 2))
    np.savez(path, time=log[:, 0], control=log[:, 1:3], position=position)
