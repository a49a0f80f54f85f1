"""The bench-top tests without a graph: what is commanded, measured and refused."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
from sher3_benchtop.cameras.pictures import Shots, rotated, taken
from sher3_benchtop.evaluation.evaluate import evaluate
from sher3_benchtop.evaluation.text import as_text, flat
from sher3_benchtop.fixture import bench_robot, grasp_from_tip
from sher3_benchtop.protocol.plan import ACCURACY, FAST, PLANES, TESTS, Plan, planned, random_order
from sher3_common import Sher3Error
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.tip_deflection import LoadBeyondRange
from sher3_paper.errors import BadData
from sher3_paper.sections.benchtop import benchtop, quantities

ROBOT = bench_robot(load_robot())


def perfect(name: str, plan: Plan = FAST, compliance=(0.0, 0.0, 0.0)) -> dict[str, Shots]:
    """Return the pictures of a robot that is where it should be and gives way by a compliance along the force [m/N]."""
    timeline, kinematics, groups = planned(name, ROBOT, plan), RobotKinematics(ROBOT), {}
    for picture in timeline.pictures:
        place = timeline.commands[picture.tick]
        tip = place if timeline.mode == "servo_cp" else kinematics.transform_tip_to_base(place)[:3, 3]
        tip = tip + np.array(compliance) * timeline.forces[picture.tick]
        groups.setdefault(picture.group, []).append((picture.target, picture.force, tip))
    columns = {name: list(zip(*rows, strict=True)) for name, rows in groups.items()}
    return {n: Shots(np.array(t), np.array(f), np.array(p), np.array(p)) for n, (t, f, p) in columns.items()}


@pytest.mark.parametrize("name", TESTS)
def test_timelines_are_smooth_and_pictures_taken_at_rest(name):
    """No step of the command is one the robot refuses, and nothing is commanded to move or push before a picture."""
    timeline, rest = planned(name, ROBOT, FAST), round(FAST.dwell / ROBOT.control_period)
    reach = 0.0122 / ROBOT.position_gain
    assert np.abs(np.diff(timeline.commands, axis=0)).max() < 0.2 * reach
    for picture in timeline.pictures:
        span = slice(picture.tick - rest + 1, picture.tick + 1)
        assert np.ptp(timeline.commands[span], axis=0).max() == 0.0
        assert np.ptp(timeline.forces[span], axis=0).max() == 0.0


def test_tests_are_the_papers():
    """Nine points once, nine and four five times, in both planes; five places, three axes, three pushes."""
    counts = {name: len(planned(name, ROBOT, Plan()).pictures) for name in ("grid_10mm", "grid_2mm", "grid_10um")}
    assert counts == {"grid_10mm": 18, "grid_2mm": 90, "grid_10um": 40}
    pushes = [p for p in planned("deflection", ROBOT, Plan()).pictures if p.force == 8.0]
    assert len(pushes) == 5 * 3 * 3


def test_random_order_visits_each_point_as_often_and_never_stays():
    for seed in range(50):
        order = random_order(4, 5, np.random.default_rng(seed))
        assert np.bincount(order).tolist() == [5, 5, 5, 5]
        assert np.diff(order).all()
    assert random_order(9, 5, np.random.default_rng(1)) == random_order(9, 5, np.random.default_rng(1))


def test_unreachable_grid_names_place_and_distance():
    with pytest.raises(Sher3Error) as caught:
        planned("grid_10mm", ROBOT, Plan(centre=(0.05, 0.0, 0.0)))
    assert caught.value.distance > 1e-3
    assert caught.value.value is not None and caught.value.limit is not None


def test_load_beyond_the_sensor_names_axis_value_and_limit():
    with pytest.raises(LoadBeyondRange, match="fx") as caught:
        planned("deflection", ROBOT, Plan(push=20.0))
    assert caught.value.value == pytest.approx(20.0) and caught.value.limit == 12.0


def test_where_the_sensor_usually_sits_the_papers_force_is_too_much():
    """Why the bench moves the sensor: the moment of 8 N at the grasp exceeds its range at its place on the tool."""
    with pytest.raises(LoadBeyondRange, match="t"):
        planned("deflection", load_robot(), Plan())


def test_a_perfect_robot_has_no_errors():
    tests = {name: perfect(name) for name in TESTS}
    figures = evaluate(tests, "tip")
    lengths = [v for name, v in figures.items() if name.split("/")[0] in ("accuracy", "repeatability", "iso9283")]
    assert len(lengths) > 20 and max(map(abs, lengths)) < 1e-6
    assert [figures[f"resolution/{p}/{a}_step"] for p in PLANES for a in p] == pytest.approx([10.0] * 4)
    assert figures["rotation/roll/step"] == pytest.approx(1e6 * np.sin(np.radians(0.02)) * 0.018, rel=1e-6)
    assert figures["rotation/tilt/step"] == pytest.approx(1e6 * np.sin(np.radians(0.02)) * 0.050, rel=1e-4)


def test_compliance_is_found_again():
    figures = evaluate({"deflection": perfect("deflection", compliance=(2e-5, 3e-4, 2.5e-4))}, "tip")
    assert [figures[f"compliance/{axis}/mean"] for axis in "xyz"] == pytest.approx([20.0, 300.0, 250.0])


def test_every_printed_figure_is_made_and_read(tmp_path):
    """`sher3 paper --benchtop` finds all of its names in what `sher3 benchtop --json` prints."""
    tests = {name: perfect(name) for name in TESTS}
    figures = {reading: evaluate(tests, reading, cameras=3) for reading in ("field", "noise", "tip")}
    assert {name for name, _, _ in quantities()} <= set(figures["field"])
    path = tmp_path / "benchtop.json"
    path.write_text(json.dumps(flat(figures)))
    lines = benchtop(path).comparisons
    assert {line.verdict for line in lines} == {"computed"}
    assert all(line.computed == figures["noise"][line.quantity] for line in lines)
    assert "accuracy/y_motion/y/mean" in as_text(figures, "test")


def test_pictures_are_taken_at_their_ticks():
    """The tip of a picture is the tracker's sample of that tick; the grasp turns with the tip."""
    timeline = planned("grid_10mm", ROBOT, FAST)
    stamp = 10**9 + np.arange(0, len(timeline), 5) * 2_000_000
    quaternion = np.tile([0.0, 0.0, np.sin(0.1), np.cos(0.1)], (len(stamp), 1))
    tracker = SimpleNamespace(stamp=stamp, position=timeline.commands[::5], orientation=quaternion)
    shots = taken(timeline, tracker, 10**9, 0.002, ROBOT)
    assert shots["xz"].plane("xz") == pytest.approx(ACCURACY.points)
    x, _, z = grasp_from_tip(ROBOT)
    turned = shots["yz"].grasp[0] - shots["yz"].tip[0]
    assert turned == pytest.approx([x * np.cos(0.2), x * np.sin(0.2), z])
    cut = SimpleNamespace(stamp=stamp[:-50], position=tracker.position[:-50], orientation=quaternion[:-50])
    with pytest.raises(BadData, match="record the whole test"):
        taken(timeline, cut, 10**9, 0.002, ROBOT)


def test_rotated_is_a_rotation():
    half = np.sqrt(0.5)
    assert rotated(np.array([[half, 0.0, 0.0, half]]), np.array([1.0, 2.0, 3.0])) == pytest.approx(
        np.array([[1.0, -3.0, 2.0]])
    )
