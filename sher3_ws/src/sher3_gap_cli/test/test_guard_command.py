"""`sher3 gap check` on logs of a drawn arm: recorded, held against, two at a time, and what is wrong."""

import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from invoking import invoke
from sher3_gap_cli.app import app

sys.path.append(str(Path(__file__).parents[2] / "sher3_chain" / "test"))

from drawn_arms import drawn_xml, logged


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """`good.npz` and `same.npz` of an arm as its model says; `rubbing.npz` with 1.2 N m more at the shoulder."""
    where = tmp_path_factory.mktemp("logs")
    xml = drawn_xml(np.random.default_rng(6), joints=2)
    (where / "arm.xml").write_text(xml)
    robot = ElementTree.fromstring(xml)
    (joint,) = [j for j in robot.iter("joint") if j.get("name") == "shoulder"]
    joint.set("frictionloss", str(float(joint.get("frictionloss")) + 1.2))
    rubbing = ElementTree.tostring(robot, encoding="unicode")
    for name, model, seed in (("good", xml, 6), ("same", xml, 7), ("rubbing", rubbing, 6)):
        log = logged(model, seed)
        np.savez(where / f"{name}.npz", time=log.time, ctrl=log.ctrl, qpos=log.qpos)
    return where


def run(folder, *words):
    return invoke(app, ["check", *(str(folder / w) if "." in w else w for w in words)])


@pytest.fixture(scope="module")
def recorded(folder):
    found = run(folder, "good.npz", "arm.xml", "--record", "good.json")
    assert found.exit_code == 0, found.output
    verdict = json.loads((folder / "good.json").read_text())["logs"]["good"]["verdict"]
    (folder / "verdict.json").write_text(json.dumps(verdict))
    return found


def test_a_log_like_the_baseline_passes_and_a_rubbing_one_does_not(folder, recorded):
    pages = ["--junit", "gap.xml", "--markdown", "gap.md"]
    found = run(folder, "same.npz", "rubbing.npz", "arm.xml", "--baseline", "verdict.json", "--jobs", "2", *pages)
    assert found.exit_code == 1, found.output
    assert "rubbing: Coulomb friction on shoulder" in found.stdout and "worse, new cause" in found.stdout
    assert found.output.count("rubbing: Coulomb friction on shoulder") == 1
    suites = {s.get("name"): s for s in ElementTree.parse(folder / "gap.xml").getroot()}
    assert [suites[n].get("failures") for n in ("same", "rubbing")] == ["0", "1"]
    (failure,) = suites["rubbing"].iter("failure")
    assert "Coulomb friction on shoulder" in failure.text
    summary = (folder / "gap.md").read_text()
    assert summary.startswith("## Gap: 1 of 2 logs worse") and summary.index("| rubbing |") < summary.index("| same |")


def test_what_was_recorded_passes_and_json_tells_all(folder, recorded):
    found = run(folder, "good.npz", "arm.xml", "--baseline", "good.json", "--json")
    (log,) = json.loads(found.stdout)["logs"]
    assert found.exit_code == 0 and log["worse"] == [] and log["verdict"]["status"] == "no_gap"


def test_a_log_that_cannot_be_read_is_named_and_the_others_are_answered(folder, recorded):
    (folder / "broken.csv").write_text("nothing\n")
    found = run(folder, "broken.csv", "good.npz", "arm.xml", "--baseline", "verdict.json", "--junit", "gap.xml")
    assert found.exit_code == 2 and "good: No gap" in found.stdout and "broken: " in found.stdout
    assert [s.get("errors") for s in ElementTree.parse(folder / "gap.xml").getroot()] == ["1", "0"]
    assert run(folder, "broken.csv", "arm.xml", "--record", "new.json").exit_code == 2
    assert not (folder / "new.json").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["good.npz", "arm.xml"], "give --baseline or --record"),
        (["arm.xml", "--record", "x.json"], "logs and a model are needed"),
        (["good.npz", "good.csv", "arm.xml", "--record", "x.json"], "logs of the same name"),
        (["good.npz", "arm.xml", "--baseline", "nowhere.json"], "cannot be read"),
        (["good.npz", "arm.xml", "--record", "nowhere/x.json"], "there is no folder"),
    ],
)
def test_what_makes_no_check_is_said(folder, words, said):
    found = run(folder, *words)
    assert found.exit_code == 2 and said in found.stderr


def test_two_traces_are_compared(folder):
    def compared(*words):
        words = ["compare-simulators", *(str(folder / w) for w in words), "--json"]
        return invoke(app, [*words, "--model", str(folder / "arm.xml")])

    found = json.loads(compared("good.npz", "rubbing.npz").stdout)
    assert "Coulomb friction on shoulder" in found["cause"] and found["settings"] == {"good": "", "rubbing": ""}
    wrong = compared("good.npz", "same.npz")
    assert wrong.exit_code == 2 and json.loads(wrong.stderr)["what"] == "commands differ"
