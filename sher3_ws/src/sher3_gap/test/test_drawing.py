"""The drawing of the robot: what is lit, and that it stays inside its frame."""

import re

from sher3_description import load_robot
from sher3_gap.report.drawing import HEIGHT, LIT, WIDTH, robot_drawing


def test_the_place_is_lit_and_named():
    page = robot_drawing(load_robot(), {"tilt"})
    assert page.count(f'stroke="{LIT}"') == 1 and ">tilt</text>" in page
    everything = robot_drawing(load_robot(), {"all"})
    assert all(f">{name}</text>" in everything for name in ("delta 1", "delta 2", "delta 3", "roll", "tilt"))
    assert LIT not in robot_drawing(load_robot(), set())


def test_every_line_is_inside():
    for points in re.findall(r'points="([^"]+)"', robot_drawing(load_robot(), {"tip", "force_sensor"})):
        pairs = [tuple(map(float, p.split(","))) for p in points.split()]
        assert all(0 <= x <= WIDTH and 0 <= y <= HEIGHT for x, y in pairs)
