"""The same nodes in processes of their own, in one process, and in stepped time: the same commands, bit for bit."""

from __future__ import annotations

import pickle
import subprocess
import sys
from functools import partial

import pytest
from layout_player import INPUTS, RATE, REST, Player, settings_of
from processes import child_environment
from robot_rig import RobotRig
from sher3_bringup.surgeon.script import demo_script, load_script
from sher3_control.nodes.admittance_node import AdmittanceNode
from sher3_control.nodes.kinematics_node import KinematicsNode
from sher3_runtime import Graph
from sher3_runtime.composed.composition import Composition
from sher3_safety.measurement.report import misses
from sher3_safety.runs.matrix import run_matrix
from sources import ROOT

pytestmark = pytest.mark.graph
FIRST_PUSH = 3
"""Steps of the demo's script: settle, enable, reach."""
PLAYS = 5
"""Times that a recording is played at most. A process that others hold up takes the newest sample alone and leaves a
command out, after which the law has another input: another play goes farther."""


@pytest.fixture(scope="module")
def settings():
    return settings_of()


@pytest.fixture(scope="module")
def recorded(settings):
    """What the devices of a whole robot said while a surgeon drove it: the first push of the demo."""
    script = load_script(demo_script())
    script = script.model_copy(update={"steps": script.steps[:FIRST_PUSH]})
    with Graph(period=1.0 / RATE, middleware=False) as graph:
        rig = RobotRig(graph, robot=settings.robot(), control=settings.control())
        probe = graph.probe(*INPUTS)
        rig.play(script)
        taken = [{sample.stamp: sample for sample in probe.samples[name]} for name in INPUTS]
    stamps = sorted(set.intersection(*map(set, taken)))
    pressed = next(k for k, stamp in enumerate(stamps) if taken[1][stamp].axes[0] > 0.0)
    return [tuple(samples[stamp] for samples in taken) for stamp in stamps[pressed - 5 : pressed + 90]]


def stepped(inputs, settings, composed):
    """Return the commands of the nodes in stepped time."""
    with Graph(period=1.0 / RATE) as graph:
        add = partial(graph.add_to, Composition()) if composed else graph.add
        player = graph.add(Player, inputs)
        add(AdmittanceNode, settings.robot(), settings.control())
        add(KinematicsNode, settings.robot(), settings.control())
        graph.step(REST + len(inputs) + 5)
        return player.commands


def in_processes(inputs, nodes, domain, folder):
    """Return the commands of the nodes in wall time."""
    source, output = folder / "inputs.pickle", folder / "commands.pickle"
    source.write_bytes(pickle.dumps(inputs))
    command = [sys.executable, str(ROOT / "tests" / "layout_player.py"), str(source), str(output), str(domain), nodes]
    subprocess.run(command, env=child_environment(), check=True, timeout=60.0)
    return pickle.loads(output.read_bytes())


@pytest.fixture(scope="module")
def expected(recorded, settings):
    """The commands in stepped time through the middleware: the robot moves, and the recording is not trivial."""
    commands = stepped(recorded, settings, composed=False)
    velocity = [value for (name, _), value in commands.items() if name == "servo_jv"]
    assert len(velocity) >= len(recorded) and sum(any(v) for v in velocity) > 50
    return commands


def test_one_process_in_stepped_time_commands_the_same(recorded, settings, expected):
    assert stepped(recorded, settings, composed=True) == expected


@pytest.mark.flaky(reruns=2)
@pytest.mark.parametrize("nodes", ["admittance,kinematics", "admittance+kinematics"])
def test_processes_in_wall_time_command_the_same(recorded, expected, domain, tmp_path, nodes):
    """Separate and composed: each command of the recording, to the last bit, until one was left out."""
    last, reached = REST + len(recorded), [0]
    while reached[-1] < last and len(reached) <= PLAYS:
        found = in_processes(recorded, nodes, domain, tmp_path)
        reached.append(min((number for name, number in expected if (name, number) not in found), default=last))
        end = min(reached[-1], last)
        assert {k: v for k, v in found.items() if k[1] < end} == {k: v for k, v in expected.items() if k[1] < end}
    assert max(reached) >= last, f"commands before the first that was left out, each play: {reached[1:]}"


@pytest.mark.slow
def test_the_compact_matrix_of_faults_holds_composed():
    """Ages, silence and supervision are the same. Where a node's process stops, the whole loop does: another name."""
    found = run_matrix(ROOT / "bags" / "tests" / "safety-composed", quick=True, composed=True).verdicts
    assert misses(found) == []
    assert {v.outcome.reason for v in found if v.row.name == "process.admittance stuck"} == {"WRENCH_STALE"}
