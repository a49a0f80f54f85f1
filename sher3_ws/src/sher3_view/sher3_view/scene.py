"""The scene: named primitives from a robot state, in {b} and in metres.

Positions follow from `robot.yaml` alone. What the file does not say is chosen for the picture and stated here: the
thickness of every part, where a rail stands behind its slider, and the orientation of the tilt linkage in its plane
(its rail along the roll arm, so that the slider runs on the arm).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from sher3_kinematics import RobotKinematics
from sher3_kinematics.arrays import Floats

Kind = Literal["rod", "bar", "ball", "arrow", "path"]
Role = Literal["frame", "rail", "slider", "leg", "joint", "platform", "arm", "linkage", "tool", "needle", "force"]

METRES_PER_NEWTON = 0.03
"""Length of the force arrow: at the 1 N of a firm hand it is half as long as the needle's holder."""
RAIL_BEHIND = 0.012
"""Distance [m] from a slider's ball centres to the middle of its rail."""
MARGIN = 0.016
"""Length [m] by which a rail goes beyond the travel of its slider."""
FLOOR = 0.012
"""Height [m] of the floor below the rails."""
WIDTH_AT = 0.05
"""Distance [m] from a bar's start to the point that tells the direction of its width."""
EDGE_POINTS = 72
"""Points of the workspace edge, one every five degrees."""
UP = np.array([0.0, 0.0, 1.0])
BISECTIONS = 30
"""Halvings of the search for the edge: 64 mm over 2^30 is far below what is drawn."""


class Primitive(NamedTuple):
    """One part of the scene.

    Attributes:
        name: of the part, unique in a scene.
        kind: `rod` (two ends), `bar` (two ends and a point 50 mm from the first in the direction of its width), `ball`
            (its centre), `arrow` (tail and head) or `path` (all corners, closed).
        role: what it is; the drawing chooses colours by it.
        size: radius of rods, balls and arrows (twice), or width and height of bars [m].
        points: (k, 3) [m] in {b}. A part that is not there has points of NaN and is not drawn.
    """

    name: str
    kind: Kind
    role: Role
    size: tuple[float, float]
    points: Floats


class RobotState(NamedTuple):
    """What the scene shows.

    Attributes:
        position: actuator positions (5,) [m, m, m, rad, m].
        force: on the tip (3,) [N] in {b}.
        remote_centre: point (3,) [m] in {b} that the needle turns about, or None.
    """

    position: Sequence[float] | Floats
    force: Sequence[float] | Floats = (0.0, 0.0, 0.0)
    remote_centre: Sequence[float] | Floats | None = None


class Scene:
    """The scene of one robot.

    Attributes:
        kinematics: of the robot.
        floor: height [m] of the floor in {b}.
    """

    def __init__(self, kinematics: RobotKinematics) -> None:
        """Take the robot from its kinematics."""
        self.kinematics = kinematics
        robot = kinematics.robot
        self._half = robot.delta.leg_width / 2
        self._base = robot.delta.base_distance
        self._platform = robot.delta.platform_distance
        self._zero = robot.delta.slider_zero
        self.floor = self._zero + float(kinematics.lower[:3].min()) - MARGIN - FLOOR

    def fixed(self) -> list[Primitive]:
        """Return the parts that never move: plate, rails with the ends of travel, edge of the workspace."""
        parts = [_rod("base", "frame", 0.098, (0, 0, self.floor + 0.001), (0, 0, self.floor + 0.006))]
        for k, azimuth in enumerate(self.kinematics.robot.delta.leg_azimuth):
            out, across = _directions(azimuth)
            foot = (self._base + RAIL_BEHIND) * out
            low, high = self._zero + self.kinematics.lower[k], self._zero + self.kinematics.upper[k]
            bottom, top = foot + (low - MARGIN) * UP, foot + (high + MARGIN) * UP
            parts.append(_bar(f"rail_{k + 1}", "rail", (0.022, 0.008), bottom, top, across))
            for end, height in (("lower", low), ("upper", high)):
                at = foot + 0.0045 * out + height * UP
                parts.append(
                    _bar(f"rail_{k + 1}_{end}", "force", (0.001, 0.001), at - 0.011 * across, at + 0.011 * across, out)
                )
        return [*parts, self.workspace_edge()]

    def moving(self, state: RobotState) -> list[Primitive]:
        """Return the parts that move, always the same ones in the same order.

        Raises:
            BadInput: the positions are not five finite numbers.
            Unreachable: the legs do not meet or the tilt slider is beyond a dead point.
        """
        q = np.asarray(state.position, dtype=float)
        tip = self.kinematics.transform_tip_to_base(q)
        centre = self.kinematics.delta.forward(q[:3])
        return [*self._delta(q, centre), *self._arm(q, centre), *self._tool(q, tip), *_signs(tip, state)]

    def workspace_edge(self) -> Primitive:
        """Return the edge of the platform's workspace at the height of the centre, a closed path."""
        delta = self.kinematics.delta
        centre = delta.forward(np.zeros(3))
        corners = []
        for angle in np.linspace(0.0, 2.0 * math.pi, EDGE_POINTS, endpoint=False):
            out = np.array([math.cos(angle), math.sin(angle), 0.0])
            inside, outside = 0.0, self.kinematics.robot.delta.link_length
            for _ in range(BISECTIONS):
                middle = 0.5 * (inside + outside)
                inside, outside = (middle, outside) if delta.contains(centre + middle * out) else (inside, middle)
            corners.append(centre + inside * out)
        return Primitive("workspace_edge", "path", "frame", (0.0, 0.0), np.array(corners))

    def _delta(self, q: Floats, centre: Floats) -> list[Primitive]:
        """Return sliders, legs with their balls, and platform."""
        parts = []
        for k, azimuth in enumerate(self.kinematics.robot.delta.leg_azimuth):
            out, across = _directions(azimuth)
            slider = self._base * out + (q[k] + self._zero) * UP
            socket = centre + self._platform * out
            middle = slider + 0.006 * out
            ends = middle - 0.011 * UP, middle + 0.011 * UP
            parts.append(_bar(f"slider_{k + 1}", "slider", (0.036, 0.010), *ends, across))
            for side, shift in (("a", -self._half * across), ("b", self._half * across)):
                parts += [
                    _rod(f"leg_{k + 1}{side}", "leg", 0.0022, slider + shift, socket + shift),
                    _ball(f"ball_{k + 1}{side}", "joint", 0.0046, slider + shift),
                    _ball(f"socket_{k + 1}{side}", "joint", 0.0046, socket + shift),
                ]
            parts.append(
                _rod(f"edge_{k + 1}", "platform", 0.003, socket - self._half * across, socket + self._half * across)
            )
        return [*parts, _rod("platform", "platform", 0.025, centre - 0.003 * UP, centre + 0.003 * UP)]

    def _arm(self, q: Floats, centre: Floats) -> list[Primitive]:
        """Return post, roll with its arm, and the tilt linkage."""
        arm, linkage = self.kinematics.robot.arm, self.kinematics.robot.tilt_linkage
        roll_centre = centre + arm.d1 * UP
        x, y, z = self._roll_axes(q)
        pivot = roll_centre + arm.d2 * x + arm.d3 * z
        elbow = roll_centre + (arm.d2 - 0.1) * x
        pin = self.crank_pin(q, pivot)
        block = self.tilt_slider(q, pivot)
        on_rail = pivot - linkage.offset * z
        reach = -self._tilt_height(0.0) * x
        low, high = (on_rail + reach - travel * x for travel in (self.kinematics.upper[4], self.kinematics.lower[4]))
        return [
            _rod("post", "arm", 0.012, centre + 0.003 * UP, roll_centre - 0.018 * UP),
            _rod("roll", "arm", 0.02, roll_centre - 0.034 * x, roll_centre + 0.024 * x),
            _rod("roll_output", "linkage", 0.016, roll_centre + 0.024 * x, roll_centre + 0.034 * x),
            _bar("roll_arm", "arm", (0.022, 0.014), roll_centre + 0.034 * x, elbow + 0.012 * x, y),
            _bar("tilt_rail", "rail", (0.012, 0.006), low - 0.012 * x - 0.009 * z, high + 0.012 * x - 0.009 * z, y),
            _bar("fork_left", "arm", (0.004, 0.014), elbow + 0.013 * y, pivot + 0.013 * y, y),
            _bar("fork_right", "arm", (0.004, 0.014), elbow - 0.013 * y, pivot - 0.013 * y, y),
            _bar("tilt_slider", "slider", (0.016, 0.010), block - 0.009 * x, block + 0.009 * x, y),
            _rod("coupler", "linkage", 0.0028, block, pin),
            _rod("crank", "linkage", 0.0034, pin, pivot),
            _ball("pin", "joint", 0.0046, pin),
            _rod("tilt_axis", "joint", 0.0055, pivot - 0.017 * y, pivot + 0.017 * y),
        ]

    def _tool(self, q: Floats, tip: Floats) -> list[Primitive]:
        """Return handle, force sensor and needle, along z of the tool."""
        point, z = tip[:3, 3], tip[:3, 2]
        pivot = point - tip[:3, :3] @ np.array(self.kinematics.robot.arm.tool)
        sensor = point + tip[:3, :3] @ np.array(self.kinematics.robot.force_sensor.position)
        return [
            _rod("handle", "tool", 0.007, sensor + 0.004 * z, pivot + 0.024 * z),
            _rod("force_sensor", "slider", 0.0085, sensor - 0.007 * z, sensor + 0.0075 * z),
            _rod("holder", "tool", 0.003, point + 0.012 * z, sensor - 0.007 * z),
            _rod("needle", "needle", 0.0004, point, point + 0.012 * z),
        ]

    def crank_pin(self, q: Floats, pivot: Floats) -> Floats:
        """Return the pin (3,) [m] of the crank for actuator positions (5,) and the tilt axis at `pivot` (3,)."""
        x, _, z = self._roll_axes(q)
        angle, crank = self.kinematics.tilt_linkage.angle(float(q[4])), self.kinematics.robot.tilt_linkage.crank
        return pivot - crank * (math.cos(angle) * z + math.sin(angle) * x)

    def tilt_slider(self, q: Floats, pivot: Floats) -> Floats:
        """Return the slider (3,) [m] of the tilt linkage; from the actuator position alone, not from the angle."""
        x, _, z = self._roll_axes(q)
        return pivot - self.kinematics.robot.tilt_linkage.offset * z - self._tilt_height(float(q[4])) * x

    def _tilt_height(self, travel: float) -> float:
        """Return the distance [m] of the tilt slider from the tilt axis along its rail."""
        linkage = self.kinematics.robot.tilt_linkage
        return travel + math.sqrt(linkage.coupler**2 - (linkage.offset - linkage.crank) ** 2)

    @staticmethod
    def _roll_axes(q: Floats) -> tuple[Floats, Floats, Floats]:
        """Return x, y and z (3,) of the frame that turns with roll."""
        s, c = math.sin(q[3]), math.cos(q[3])
        return np.array([1.0, 0.0, 0.0]), np.array([0.0, c, s]), np.array([0.0, -s, c])


def _signs(tip: Floats, state: RobotState) -> list[Primitive]:
    """Return what is no part of the robot: the force and the remote centre."""
    point = tip[:3, 3]
    centre = (math.nan,) * 3 if state.remote_centre is None else state.remote_centre
    head = point + METRES_PER_NEWTON * np.asarray(state.force, dtype=float)
    return [
        Primitive("force", "arrow", "force", (0.0016, 0.0016), np.array([point, head])),
        _ball("remote_centre", "force", 0.0016, centre),
    ]


def _directions(azimuth: float) -> tuple[Floats, Floats]:
    """Return the outward and the tangential unit vector (3,) of a leg."""
    c, s = math.cos(azimuth), math.sin(azimuth)
    return np.array([c, s, 0.0]), np.array([-s, c, 0.0])


Point = Sequence[float] | Floats


def _rod(name: str, role: Role, radius: float, start: Point, end: Point) -> Primitive:
    return Primitive(name, "rod", role, (radius, radius), np.array([start, end], dtype=float))


def _ball(name: str, role: Role, radius: float, centre: Point) -> Primitive:
    return Primitive(name, "ball", role, (radius, radius), np.array([centre], dtype=float))


def _bar(name: str, role: Role, size: tuple[float, float], start: Point, end: Point, across: Floats) -> Primitive:
    """Return a bar whose width lies along the unit vector `across` (3,)."""
    points = np.array([start, end, np.asarray(start) + WIDTH_AT * across], dtype=float)
    return Primitive(name, "bar", role, size, points)
