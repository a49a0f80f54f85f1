"""The live page: the scene, the panel and the plots in viser's browser client, served on this machine alone."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from sher3_kinematics import RobotKinematics

from sher3_view.errors import ExtraMissing
from sher3_view.live import LOOPBACK
from sher3_view.live.mock_panel import MockPanel
from sher3_view.live.plot import WINDOW, plot_svg
from sher3_view.live.snapshot import Snapshot
from sher3_view.scene import Primitive, RobotState, Scene

COLOURS = {
    "frame": (204, 212, 219),
    "rail": (158, 168, 178),
    "slider": (43, 108, 176),
    "leg": (219, 224, 230),
    "joint": (76, 87, 99),
    "platform": (51, 64, 79),
    "arm": (84, 97, 112),
    "linkage": (178, 186, 194),
    "tool": (224, 230, 235),
    "needle": (107, 115, 125),
    "force": (230, 82, 15),
}
PLOTS = (
    ("Force on the tip", "N", "#d9480f"),
    ("Speed of the tip", "mm/s", "#2b6cb0"),
    ("Largest tracking error of the sliders", "", "#2f9e44"),
)
"""Title, unit and colour of the plots; the unit of the tracking error follows the mode."""
STEP = 2e-6
"""Motion [m] below which a part is not sent again: a hundredth of a pixel, and above the noise of the encoders."""
SLOWLY = 0.2
"""Seconds between two updates of text, path and plots: faster than anybody reads."""
AROUND = 48
"""Faces of a round rod."""
PROFILES = {
    "rod": ((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 1.0), (0.0, 1.0)),
    "arrow": ((0.0, 0.0), (1.0, 0.0), (1.0, 0.78), (2.6, 0.78), (2.6, 0.78), (0.0, 1.0)),
}
"""Radius and height of the bodies of unit size; a repeated point keeps its edge sharp."""


class LivePage:
    """The page in the browser.

    Attributes:
        url: where it is served.
        mocks: what a visitor asks of the mocks.
    """

    def __init__(self, kinematics: RobotKinematics, port: int, effects: Mapping[str, Sequence[str]]) -> None:
        """Serve on the loopback interface; `effects` are those the mocks can have, with their places.

        Raises:
            ExtraMissing: viser is not installed.
        """
        viser = _viser()
        self._robot, self._scene = kinematics.robot, Scene(kinematics)
        self._server = viser.ViserServer(host=LOOPBACK, port=port, label="SHER 3.0", verbose=False)
        self.url = f"http://{LOOPBACK}:{self._server.get_port()}"
        self._server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
        self._server.gui.main_panel.dock_right()
        self._server.initial_camera.position = (0.48, -0.46, 0.28)
        self._server.initial_camera.look_at = (0.07, 0.0, 0.05)
        self._server.initial_camera.fov = 0.55
        self._server.scene.add_grid(
            "floor", 0.6, 0.6, cell_size=0.02, section_size=0.1, position=(0, 0, self._scene.floor)
        )
        for part in self._scene.fixed():
            self._add(part)
        self._shown = self._scene.moving(RobotState((0.0,) * 5))
        self._moving = [self._add(part) for part in self._shown]
        self._path = self._line("path", np.zeros((2, 3)), (43, 108, 176))
        self._history: deque[tuple[float, float, float, float, NDArray[np.float64]]] = deque()
        self._tracked = ""
        self._panel = self._server.gui.add_markdown("### Waiting for the robot")
        self._plots = [self._server.gui.add_html("") for _ in PLOTS]
        self.mocks = MockPanel(self._server.gui, effects)
        self._slow = 0.0

    def show(self, snapshot: Snapshot, now: int) -> None:
        """Show a moment; `now` is the time [ns]."""
        seconds = time.monotonic()
        slowly = seconds - self._slow >= SLOWLY
        with self._server.atomic():
            if snapshot.position is not None:
                state = RobotState(snapshot.position, snapshot.force, snapshot.remote_centre)
                parts = self._scene.moving(state)
                self._place(parts)
                tip = next(part for part in parts if part.name == "needle").points[0]
                self._remember(seconds, snapshot, tip)
            if slowly:
                self._slow = seconds
                self._panel.content = snapshot.text(self._robot, now)
                self._draw_history()

    def close(self) -> None:
        """Stop serving."""
        self._server.stop()

    def _remember(self, seconds: float, snapshot: Snapshot, tip: NDArray[np.float64]) -> None:
        force = float(np.linalg.norm(snapshot.force))
        kind, errors = snapshot.tracking() or (self._tracked, (0.0,) * 5)
        if kind != self._tracked:
            # Micrometres and micrometres per second do not go into one plot.
            self._history.clear()
            self._tracked = kind
        error = max(map(abs, errors[:3])) * 1e6
        self._history.append((seconds, force, snapshot.speed * 1e3, error, tip))
        while self._history[0][0] < seconds - WINDOW:
            self._history.popleft()

    def _draw_history(self) -> None:
        if len(self._history) < 2:
            return
        path = np.array([row[4] for row in self._history])
        self._path.points = np.stack([path[:-1], path[1:]], axis=1).astype(np.float32)
        times = np.array([row[0] for row in self._history]) - self._history[-1][0]
        for handle, (title, unit, colour), column in zip(self._plots, PLOTS, (1, 2, 3), strict=True):
            values = np.array([row[column] for row in self._history])
            shown = unit or ("µm" if self._tracked == "position" else "µm/s")
            handle.content = plot_svg(times, values, title, shown, colour)

    def _add(self, part: Primitive) -> Any:
        name, colour = f"robot/{part.name}", COLOURS[part.role]
        if part.kind == "path":
            closed = np.concatenate([part.points, part.points[:1]])
            return self._line(part.name, closed, (138, 151, 165))
        if part.kind == "ball":
            handle = self._server.scene.add_icosphere(name, part.size[0], colour)
        elif part.kind == "bar":
            length = float(np.linalg.norm(part.points[1] - part.points[0]))
            handle = self._server.scene.add_box(name, colour, (*part.size, length))
        else:
            handle = self._server.scene.add_mesh_simple(name, *revolved(PROFILES[part.kind]), color=colour)
        self._put(handle, part)
        return handle

    def _line(self, name: str, points: NDArray[np.float64], colour: tuple[int, int, int]) -> Any:
        pairs = np.stack([points[:-1], points[1:]], axis=1)
        return self._server.scene.add_line_segments(name, pairs, colour, thickness=2.0, thickness_units="screen")

    def _place(self, parts: list[Primitive]) -> None:
        """Move what has moved: a robot at rest sends nothing to the browser."""
        for k, (handle, part) in enumerate(zip(self._moving, parts, strict=True)):
            if not np.allclose(part.points, self._shown[k].points, rtol=0.0, atol=STEP, equal_nan=True):
                self._put(handle, part)
                self._shown[k] = part

    def _put(self, handle: Any, part: Primitive) -> None:
        there = bool(np.isfinite(part.points).all())
        if handle.visible != there:
            handle.visible = there
        if not there:
            return
        position, wxyz, length = pose_of(part)
        handle.position = position
        if part.kind == "ball":
            return
        handle.wxyz = wxyz
        # A short arrow is thin too: its head keeps its shape.
        thick = part.size if part.kind != "arrow" else (min(part.size[0], 0.1 * length),) * 2
        size = (*thick, max(length, 1e-5))
        if part.kind != "bar" and not np.allclose(handle.scale, size, rtol=0.0, atol=STEP):
            handle.scale = size


def pose_of(part: Primitive) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return position (3,), quaternion (4, w x y z) and length of a part whose mesh lies along z.

    The mesh of a rod begins at its origin, that of a bar has its origin in the middle.
    """
    start = part.points[0]
    if part.kind == "ball":
        return start, np.array([1.0, 0.0, 0.0, 0.0]), 0.0
    along = part.points[1] - start
    length = float(np.linalg.norm(along))
    z = along / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    side = part.points[2] - start if part.kind == "bar" else np.eye(3)[int(np.argmin(np.abs(z)))]
    x = side - (side @ z) * z
    x /= np.linalg.norm(x)
    quaternion = Rotation.from_matrix(np.stack([x, np.cross(z, x), z], axis=1)).as_quat()
    origin = start + 0.5 * along if part.kind == "bar" else start
    return origin, quaternion[[3, 0, 1, 2]], length


def revolved(profile: Sequence[tuple[float, float]]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices (48 m, 3) and triangles of the body that a profile of m points (radius, z) sweeps about z."""
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    rings = [np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(AROUND, z)]) for r, z in profile]
    a = np.arange(AROUND)
    b = (a + 1) % AROUND
    faces = []
    for low in range(0, AROUND * (len(profile) - 1), AROUND):
        high = low + AROUND
        faces += [np.stack([low + a, low + b, high + b], 1), np.stack([low + a, high + b, high + a], 1)]
    return np.concatenate(rings), np.concatenate(faces)


def _viser() -> Any:
    try:
        return import_module("viser")
    except ImportError as error:
        raise ExtraMissing("viser") from error
