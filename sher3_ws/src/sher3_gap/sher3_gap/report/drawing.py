"""The robot as a line drawing, with the places of a gap lit."""

from __future__ import annotations

from collections.abc import Collection
from html import escape

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_kinematics.kernel import delta_forward, kernel_parameters

WIDTH, HEIGHT, MARGIN = 420, 300, 30
"""Size and margin of the picture, px."""
ABOUT, DOWN = np.radians(-24.0), np.radians(-72.0)
FROM = np.array(
    [
        [np.cos(ABOUT), -np.sin(ABOUT), 0.0],
        [np.sin(ABOUT) * np.cos(DOWN), np.cos(ABOUT) * np.cos(DOWN), -np.sin(DOWN)],
    ]
)
"""Abscissa and ordinate of the picture in the base frame: the robot from its side, a little from above."""
RAIL = (-0.045, 0.045)
"""Ends of a rail about its slider, m."""
LIT, PLAIN = "#c2412d", "#64748b"
NAMES = {"tip": "tip", "force_sensor": "force sensor"}
Line = tuple[Array, float]
"""Points (n, 3), m, and a width, px."""


def robot_drawing(robot: Robot, lit: Collection[str]) -> str:
    """Return the drawing as SVG; `lit` are actuators, `tip`, `force_sensor` or `all`."""
    parts = _parts(robot)
    flat = {name: [(p @ FROM.T, w) for p, w in lines] for name, lines in parts.items()}
    every = np.vstack([p for lines in flat.values() for p, _ in lines])
    low, high = every.min(axis=0), every.max(axis=0)
    scale = float(min((WIDTH - 2 * MARGIN) / (high - low)[0], (HEIGHT - 2 * MARGIN) / (high - low)[1]))
    offset = (np.array([WIDTH, HEIGHT]) - scale * (high - low)) / 2
    shown = set(ACTUATORS) if "all" in lit else set(lit)
    out = []
    for name, lines in flat.items():
        bright = name in shown
        for points, width in lines:
            x = offset + scale * (points - low)
            path = " ".join(f"{a:.1f},{HEIGHT - b:.1f}" for a, b in x)
            look = f'stroke="{LIT if bright else PLAIN}" stroke-width="{width + 1.5 * bright:.1f}"'
            out.append(f'<polyline points="{path}" {look} opacity="{1.0 if bright else 0.55}"/>')
        if bright:
            bright_ones = offset + scale * (np.vstack([p for p, _ in lines]) - low)
            top = HEIGHT - bright_ones[:, 1].max()
            out.append(_label(NAMES.get(name, name.replace("_", " ")), bright_ones[:, 0].mean(), top))
    title = escape(f"the robot; lit: {', '.join(sorted(shown)) or 'nothing'}")
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{title}" fill="none" stroke-linecap="round">'
    return head + "".join(out) + "</svg>"


def _label(text: str, x: float, top: float) -> str:
    """Return a name above what is lit."""
    look = f'fill="{LIT}" font-size="15" font-weight="600" paint-order="stroke" stroke="#fff" stroke-width="4"'
    return f'<text x="{x:.1f}" y="{max(top - 8.0, 16.0):.1f}" text-anchor="middle" {look}>{escape(text)}</text>'


def _parts(robot: Robot) -> dict[str, list[Line]]:
    """Return the lines of every place at zero position, what stays in place under the empty name."""
    delta, arm = robot.delta, robot.arm
    centre = np.array(delta_forward(kernel_parameters(robot), 0.0, 0.0, 0.0))
    up = np.array([0.0, 0.0, 1.0])
    ring = np.linspace(0.0, 2.0 * np.pi, 49)
    circle = np.column_stack([np.cos(ring), np.sin(ring), 0.0 * ring])
    base = delta.base_radius * circle
    parts: dict[str, list[Line]] = {
        "": [(base + RAIL[0] * up, 1.5), (base + RAIL[1] * up, 1.0), (centre + delta.platform_radius * circle, 2.0)]
    }
    for k, azimuth in enumerate(delta.leg_azimuth):
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        across = 0.5 * delta.leg_width * np.array([-out[1], out[0], 0.0])
        slider, ball = delta.base_radius * out + delta.slider_zero * up, centre + delta.platform_radius * out
        rail = delta.base_radius * out + np.outer(RAIL, up)
        links: list[Line] = [(np.array([slider + s * across, ball + s * across]), 1.8) for s in (-1.0, 1.0)]
        parts[f"delta_{k + 1}"] = [(np.array([slider - across, slider + across]), 4.0), (rail, 2.5), *links]
    roll = centre + arm.d1 * up
    elbow = roll + np.array([arm.d2, 0.0, arm.d3])
    crank = elbow + robot.tilt_linkage.crank * up
    tip = elbow + np.array(arm.tool)
    sensor = tip + np.array(robot.force_sensor.position)
    parts["roll"] = [
        (np.array([roll, roll + np.array([arm.d2, 0.0, 0.0]), elbow]), 3.0),
        (np.array([centre, roll]), 3.0),
    ]
    parts["tilt"] = [(np.array([crank - np.array([robot.tilt_linkage.coupler, 0.0, 0.0]), crank, elbow]), 2.5)]
    parts["force_sensor"] = [(np.array([sensor - 0.006 * up, sensor + 0.006 * up]), 7.0)]
    parts["tip"] = [(np.array([elbow, tip]), 2.5)]
    return parts
