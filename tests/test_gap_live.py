"""The loop of the gap diagnosis on the graph: robot, recorded case, verdict, corrected simulator, smaller gap."""

from __future__ import annotations

import json
import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from processes import child_environment, sher3_command
from robot_rig import ROBOT
from sher3_bags import Stream, read_case, write_case
from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bags.run import Run
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_effects import plants, save_effects
from sher3_gap import diagnose_case
from sher3_gap.case.loading import load_case
from sher3_gap.excitation import excite
from sher3_gap.simulate.apply import apply_verdict, compare_cases
from sher3_runtime import Graph

pytestmark = pytest.mark.graph
BACKLASH = plants()["backlash"]("tilt", width=6e-5)


def play(case: Path, effects, labels, repeats: int, duration: float) -> Path:
    """Play excitations on every node of the robot in stepped time and write the recordings as a case."""
    from sher3_gap.excitation.excite_node import RECORDED, ExciteNode, trimmed
    from sher3_gap.excitation.player import Heard, Phase, Player

    wanted = [(excite(label, ROBOT, duration=duration), repeat) for label in labels for repeat in range(repeats)]
    heard = Heard()
    players = [Player(excitation, ROBOT, heard) for excitation, _ in wanted]
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        SteppedRobot(graph, effects, robot=ROBOT)
        with recorded(graph, f"gap_live_{case.name}", topics=RECORDED, robot=ROBOT) as recorder:
            node = graph.add(ExciteNode, players[0])
            for player in players:
                node.player, node.finished = player, False
                for _ in range(400):
                    graph.step(25)
                    if node.finished:
                        break
                assert node.failure is None and player.phase is Phase.DONE
    whole = read_run(recorder.recorder.folder)
    runs = [
        replace(trimmed(whole, p.first, p.last), metadata=excitation.metadata(repeat, origin="robot"))
        for p, (excitation, repeat) in zip(players, wanted, strict=True)
    ]
    return write_case(case, runs, ROBOT)


@pytest.fixture(scope="module")
def stepped_case(tmp_path_factory) -> Path:
    """A robot with lost motion in the tilt drive, played and recorded in stepped time."""
    return play(tmp_path_factory.mktemp("live") / "robot", [BACKLASH], ["sweep"], repeats=2, duration=2.0)


def test_a_recorded_robot_is_diagnosed_and_its_corrected_simulator_shows_a_smaller_gap(stepped_case, tmp_path):
    verdict = diagnose_case(stepped_case).verdict
    assert verdict.status == "attributed", verdict.notes
    (cause,) = verdict.causes
    assert (cause.effect, cause.actuator) == ("backlash", "tilt")
    assert cause.parameters["width"].value == pytest.approx(6e-5, rel=0.1)

    verdict.write(tmp_path / "verdict.json")
    effects = apply_verdict(tmp_path / "verdict.json", tmp_path / "corrected.yaml", ROBOT)
    corrected = play(tmp_path / "corrected", effects, ["sweep"], repeats=1, duration=2.0)
    stages = compare_cases(load_case(stepped_case)[0], ROBOT, load_case(corrected)[0])
    (tilt,) = [s for s in stages if (s.stage, s.actuator) == ("transmission", "tilt")]
    assert tilt.after < 0.1 * tilt.before
    (tip,) = [s for s in stages if s.stage == "end to end"]
    assert tip.after < 0.3 * tip.before


def disturbed(run: Run, seed: int, share: float = 0.02) -> Run:
    """Return a live recording as a busy machine leaves it: ticks without samples, and single samples that are lost."""
    rng = np.random.default_rng(seed)
    ticks = run["drives/measured_js"].stamp
    gone = rng.choice(ticks[20:-20], round(share * len(ticks)), replace=False)
    streams = {}
    for topic, stream in run.streams.items():
        lost = set(gone.tolist())
        if topic in ("servo_jv", "measured_js"):
            lost |= set(rng.choice(ticks[20:-20], 3, replace=False).tolist())
        keep = np.array([s not in lost for s in stream.stamp.tolist()])
        if "data" not in stream.columns:
            columns = {name: np.asarray(x)[keep] for name, x in stream.columns.items()}
            stream = Stream(stream.type, stream.stamp[keep], stream.frame_id, columns)
        streams[topic] = stream
    return replace(run, streams=streams)


def test_lost_samples_change_no_verdict(stepped_case, tmp_path):
    case = read_case(stepped_case)
    spoiled = [disturbed(run, k) for k, run in enumerate(case.runs)]
    verdict = diagnose_case(write_case(tmp_path / "spoiled", spoiled, ROBOT)).verdict
    assert verdict.status == "attributed"
    assert [(c.effect, c.actuator) for c in verdict.causes] == [("backlash", "tilt")]
    assert any("ticks were not recorded" in note for note in verdict.notes)


class Up:
    """`sher3 up` in processes of its own while the block runs: three, as it advises a machine too busy to record."""

    def __init__(self, effects: Path, domain: int) -> None:
        options = ("--effects", effects, "--domain", domain, "--realtime", "0", "--patient", "--layout", "composed")
        self._command = sher3_command("up", *options, "--monitor")

    def __enter__(self) -> Up:
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen(self._command, env=child_environment(), **pipes)
        line = self.process.stdout.readline()
        assert line.startswith("ready"), line + self.process.stderr.read()
        return self

    def __exit__(self, *_: object) -> None:
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.communicate(timeout=30.0)
        finally:
            if self.process.poll() is None:
                self.process.kill()


@pytest.mark.slow
@pytest.mark.flaky(reruns=2)
def test_the_loop_across_processes(sher3, domain, tmp_path):
    """The commands a user types, each in a process of its own, on a machine that may be busy."""
    save_effects(tmp_path / "robot.yaml", [BACKLASH])
    robot, corrected = tmp_path / "robot_case", tmp_path / "corrected_case"
    excitations = ("gap", "excite", "sweep,loads", "--domain", domain)
    with Up(tmp_path / "robot.yaml", domain):
        done = sher3(*excitations, "--repeats", 2, "-o", robot, timeout=300.0)
        assert done.returncode == 0, done.stderr
    done = sher3("gap", "diagnose", robot, "--out", tmp_path, "--json", timeout=120.0)
    assert done.returncode == 0, done.stderr
    verdict = json.loads(done.stdout)["cases"][0]["verdict"]
    assert [(c["effect"], c["actuator"]) for c in verdict["causes"]] == [("backlash", "tilt")], verdict["notes"]
    effects = tmp_path / "corrected.yaml"
    assert sher3("gap", "apply", tmp_path / "verdict.json", "-o", effects, "--case", robot).returncode == 0
    with Up(effects, domain):
        done = sher3(*excitations, "--repeats", 1, "-o", corrected, timeout=300.0)
        assert done.returncode == 0, done.stderr
    done = sher3("gap", "compare", robot, corrected, "--json", timeout=120.0)
    stages = json.loads(done.stdout)["stages"]
    (tilt,) = [s for s in stages if (s["stage"], s["actuator"]) == ("transmission", "tilt")]
    assert tilt["after"] < 0.3 * tilt["before"]
