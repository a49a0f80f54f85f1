"""The scene against robot.yaml and against numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_view import RobotState, Scene

ROBOT = load_robot()
KINEMATICS = RobotKinematics(ROBOT)
SCENE = Scene(KINEMATICS)
POSTURES = [(0, 0, 0, 0, 0), (0.004, -0.003, 0.001, -0.2, 0.005), (-0.02, -0.015, -0.018, 0.6, -0.02)]


def parts(q, **state):
    return {part.name: part for part in SCENE.moving(RobotState(q, **state))}


def length(part):
    return float(np.linalg.norm(part.points[1] - part.points[0]))


def test_the_centre_by_hand():
    """Sliders at 58.5 mm, sockets at 26.0 mm: legs of 64 mm rise by sqrt(64^2 - 32.53^2) = 55.1 mm."""
    base, platform = math.sqrt(0.061855**2 - 0.02**2), math.sqrt(0.0328**2 - 0.02**2)
    height = math.sqrt(0.064**2 - (base - platform) ** 2)
    assert height == pytest.approx(0.0551, abs=1e-4)
    shown = parts((0, 0, 0, 0, 0))
    assert shown["ball_1a"].points[0] == pytest.approx([base, -0.02, 0.0])
    assert shown["socket_1b"].points[0] == pytest.approx([platform, 0.02, height])
    # The tip lies d2 in front of the platform, and d1 + d3 - tool = 60 + 32 - 50 = 42 mm above it.
    assert shown["needle"].points[0] == pytest.approx([0.2, 0.0, height + 0.042])


@pytest.mark.parametrize("q", POSTURES)
def test_the_needle_ends_at_the_tip(q):
    tip = KINEMATICS.transform_tip_to_base(q)
    needle = parts(q)["needle"]
    assert needle.points[0] == pytest.approx(tip[:3, 3], abs=1e-12)
    assert (needle.points[1] - needle.points[0]) / length(needle) == pytest.approx(tip[:3, 2])


@pytest.mark.parametrize("q", POSTURES)
def test_legs_and_linkage_keep_their_length(q):
    """The linkage closes: its slider comes from the actuator, its pin from the angle, and the coupler spans both."""
    shown = parts(q)
    for name in ("1a", "1b", "2a", "2b", "3a", "3b"):
        assert length(shown[f"leg_{name}"]) == pytest.approx(ROBOT.delta.link_length, abs=1e-12)
    for k in (1, 2, 3):
        assert length(shown[f"edge_{k}"]) == pytest.approx(ROBOT.delta.leg_width)
    assert length(shown["coupler"]) == pytest.approx(ROBOT.tilt_linkage.coupler, abs=1e-12)
    assert length(shown["crank"]) == pytest.approx(ROBOT.tilt_linkage.crank, abs=1e-12)


def test_the_tilt_slider_travels_as_its_actuator():
    before, after = (parts((0, 0, 0, 0, q))["tilt_slider"].points[0] for q in (0.0, 0.01))
    assert after - before == pytest.approx([-0.01, 0.0, 0.0])


def test_the_crank_turns_with_the_tool():
    """Crank and needle lie along the same line at every tilt: both point along -z of the tilted frame."""
    for q in POSTURES:
        shown = parts(q)
        crank = shown["crank"].points[0] - shown["crank"].points[1]
        assert crank / np.linalg.norm(crank) == pytest.approx(-KINEMATICS.transform_tip_to_base(q)[:3, 2])


def test_the_arrow_is_30_mm_per_newton():
    arrow = parts((0, 0, 0, 0, 0), force=(0.0, 2.0, 0.0))["force"]
    assert arrow.points[1] - arrow.points[0] == pytest.approx([0.0, 0.06, 0.0])


def test_a_remote_centre_that_is_not_there_is_not_drawn():
    assert np.isnan(parts((0, 0, 0, 0, 0))["remote_centre"].points).all()
    assert parts((0, 0, 0, 0, 0), remote_centre=(0.2, 0, 0.1))["remote_centre"].points[0] == pytest.approx(
        [0.2, 0, 0.1]
    )


def test_the_workspace_edge_is_the_edge():
    edge = SCENE.workspace_edge().points
    assert len(edge) == 72
    assert max(abs(KINEMATICS.delta.edge_distance(corner)) for corner in edge) < 1e-6


def test_every_part_has_a_name_of_its_own_and_the_points_of_its_kind():
    shown = [*SCENE.fixed(), *SCENE.moving(RobotState((0, 0, 0, 0, 0)))]
    assert len({part.name for part in shown}) == len(shown)
    counts = {"rod": 2, "bar": 3, "ball": 1, "arrow": 2, "path": 72}
    assert all(part.points.shape == (counts[part.kind], 3) for part in shown)


def test_the_rails_mark_the_ends_of_travel():
    shown = {part.name: part for part in SCENE.fixed()}
    assert shown["rail_2_lower"].points[0][2] == pytest.approx(-0.038)
    assert shown["rail_2_upper"].points[0][2] == pytest.approx(0.038)
