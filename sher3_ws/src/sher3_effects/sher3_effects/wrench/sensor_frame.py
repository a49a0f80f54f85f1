"""Sensor frame: the frame of the readings is another one than stated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_common.numbers.cross import skew
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.sensor_view import SensorView


class SensorFrame(Page):
    """reading = wrench in a frame that is turned: by quarter turns, by a small angle, or both."""

    id, family, stage = "sensor_frame", "geometry", "sensing"
    kinds, places = ("sensor",), ("force_sensor",)
    inputs = ("posture", "load")
    discrete = frozenset({"frame"})
    units = {"rx": "rad", "ry": "rad", "rz": "rad"}
    best = Best("loads", "a known load in several orientations shows every frame")
    explanation = (
        "The sensor reads the right force along the wrong axes: it is mounted otherwise than stated, its orientation "
        "is stated the other way round, or it reads the reaction."
    )
    siblings = {"force_crosstalk": "the size of the force changes too", "tool_gravity": "the direction is right"}

    def shapes(self, views: Sequence[SensorView], site: str) -> list[Shape]:
        """Return every frame of the list, and each turned by what fits the forces best, rad."""
        plain: list[Shape] = [{"frame": float(k)} for k in range(views[0].frames)]
        turns = [views[0].turn(k) for k in range(views[0].frames)]
        small = [(k, turn) for k, turn in enumerate(turns) if np.linalg.norm(turn) < self.FURTHEST]
        return plain + [{"frame": float(k), "rx": t[0], "ry": t[1], "rz": t[2]} for k, t in small]

    def signature(self, view: SensorView, site: str, shape: Shape) -> Signature:
        """Return what the turn changes, and three columns: the change per rad of a further turn about each axis."""
        from scipy.spatial.transform import Rotation  # slow to import, and not needed before a case is read

        turn = Rotation.from_rotvec([shape.get(name, 0.0) for name in ("rx", "ry", "rz")])
        wrench = view.wrench(int(shape["frame"]))
        wrench = np.hstack([turn.apply(wrench[:, :3]), turn.apply(wrench[:, 3:])])
        columns = -np.concatenate([skew(wrench[:, :3]), skew(wrench[:, 3:])], axis=1)
        channel = Channel(self.stage, site)
        return Signature({channel: columns}, {channel: wrench - view.wrench(0)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the number of the frame, and the further turn of the readings [rad]: the shape's and (3,)."""
        turned = {n: shape.get(n, 0.0) + float(c) for n, c in zip(("rx", "ry", "rz"), coefficients, strict=True)}
        return {"frame": shape["frame"], **turned}

    def in_words(self, view: SensorView, values: Mapping[str, float]) -> str:
        """Return the frame of the readings, unless it is the stated frame."""
        return view.frame_in_words(round(values["frame"]), [values[name] for name in ("rx", "ry", "rz")])

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the further turn (3,) [rad] is small: what is larger is another frame of the list."""
        return bool(np.abs(coefficients).max() < self.SMALL)

    FURTHEST = 1.1
    """Largest turn to the nearest quarter turns, rad: 62.8 degrees, about an axis through the corner of a cube."""
    SMALL = 0.5
    """Largest turn, rad, beyond the turn that fits the forces: a larger one means another frame."""
