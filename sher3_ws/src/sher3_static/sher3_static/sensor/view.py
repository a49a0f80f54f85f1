"""Readings as effects and engine see them; they are no course in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion

from sher3_static.sensor.frames import frames


@dataclass(frozen=True, eq=False)
class ReadingsView:
    """All readings of a sensor.

    Attributes:
        orientation: (g, 3, 3) sensor in the upright frame.
        mass: nominal or identified, kg.
        moment: (3,) first moment, mass times centre, kg m.
        temperature: (g,) above the first reading's, K; zero where it was not recorded.
        force: (g, 3) readings, N.
    """

    orientation: Array
    mass: float
    moment: Array
    temperature: Array
    force: Array

    @cached_property
    def gravity(self) -> Array:
        """(g, 3) acceleration of gravity in the stated frame, m/s^2."""
        return frames()[0].gravity(self.orientation)

    @property
    def frames(self) -> int:
        """Number of frames that readings may be in."""
        return len(frames())

    def wrench(self, frame: int) -> Array:
        """Return (g, 6) nominal wrench in one of the frames; the centre is where the stated frame has it."""
        gravity = frames()[frame].gravity(self.orientation)
        return np.hstack([self.mass * gravity, np.cross(frames()[frame].turn @ self.moment, gravity)])

    def turn(self, frame: int) -> Array:
        """Return (3,) rotation vector by which forces in a frame fit the readings best, whatever their bias, rad.

        Source: Kabsch, Acta Crystallographica A32, 1976.
        """
        gravity = frames()[frame].gravity(self.orientation)
        u, _, vt = np.linalg.svd((self.force - self.force.mean(axis=0)).T @ (gravity - gravity.mean(axis=0)))
        matrix = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
        return Rotation.from_matrix(matrix).as_rotvec()

    @property
    def elapsed(self) -> Array:
        """(g,) share of the record that had passed."""
        return np.linspace(0.0, 1.0, len(self.orientation))

    @property
    def warmth(self) -> Array:
        """(g,) temperature above the first reading's, K."""
        return self.temperature

    # as pages of the robot's sensor ask for it

    @property
    def run(self) -> SimpleNamespace:
        """Carries `grid`, one entry for each reading."""
        return SimpleNamespace(grid=np.arange(len(self.orientation)))

    @cached_property
    def path(self) -> SimpleNamespace:
        """Carries `nominal_wrench` (g, 6)."""
        return SimpleNamespace(nominal_wrench=self.wrench(0))

    # what the engine reads

    @property
    def excitation(self) -> str:
        """Name of what was recorded."""
        return "orientations"

    @property
    def rate(self) -> None:
        """None: readings are no course in time."""

    @property
    def loaded(self) -> Mask:
        """(g,) False: no load beside the weight."""
        return np.zeros(len(self.orientation), dtype=bool)

    @property
    def temperature_known(self) -> bool:
        """Whether the temperature was recorded."""
        return bool(self.temperature.any())

    @property
    def speed_share(self) -> Array:
        """(g,) zero: the sensor is at rest."""
        return np.zeros(len(self.orientation))

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None

    def inputs(self, actuator: str) -> Array:
        """Return the direction of gravity and the share that had passed, (g, 4)."""
        return np.column_stack([self.gravity, self.elapsed])
