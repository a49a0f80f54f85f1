"""Readings of a force sensor as effects see them: under a load that turns with it, or under known weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array
from sher3_effects.table_view import Still

from sher3_static.sensor.frames import Frame, frames, turned


@dataclass(frozen=True, eq=False)
class SensorView(Still):
    """All readings of a sensor.

    Attributes:
        reading: (g, 6) N and N m.
    """

    reading: Array

    @property
    def known_frames(self) -> Sequence[Frame]:
        """Frames that the readings may be in, the stated one first; raises NotImplementedError here."""
        raise NotImplementedError

    @property
    def conditions(self) -> Array:
        """(g, k) what a linear sensor reads a combination of; raises NotImplementedError here."""
        raise NotImplementedError

    def wrench(self, frame: int) -> Array:
        """Return (g, 6) nominal wrench in one of the frames, N and N m; raises NotImplementedError here."""
        raise NotImplementedError

    def pulls(self, frame: int) -> Sequence[tuple[Array, Array]]:
        """Return readings and what they follow in one of the frames, (g, 3) each, to find a turn between them.

        Raises:
            NotImplementedError: here; each kind of load has its own.
        """
        raise NotImplementedError

    def in_words(self) -> list[str]:
        """Return what is known of the load; default nothing."""
        return []

    @property
    def frames(self) -> int:
        """Number of frames that readings may be in."""
        return len(self.known_frames)

    def turn(self, frame: int) -> Array:
        """Return (3,) rotation vector by which nominal forces in a frame fit the readings best, whatever their bias.

        Source: Kabsch, Acta Crystallographica A32, 1976.
        """
        product = np.zeros((3, 3))
        for reading, nominal in self.pulls(frame):
            a, b = reading - reading.mean(axis=0), nominal - nominal.mean(axis=0)
            product += a.T @ b / max(float(np.linalg.norm(a) * np.linalg.norm(b)), np.finfo(float).tiny)
        u, _, vt = np.linalg.svd(product)
        return Rotation.from_matrix(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt).as_rotvec()

    def frame_in_words(self, frame: int, further: Sequence[float]) -> str:
        """Return how readings are expressed in a frame that is turned further by a rotation vector, rad."""
        said = str(turned(self.known_frames[frame], further))
        stated = said == str(self.known_frames[0])
        return "" if stated else f"the frame of the sensor is stated wrongly: {said}"

    # as pages of the robot's sensor ask for it

    @property
    def run(self) -> SimpleNamespace:
        """Carries `grid`, one entry for each reading."""
        return SimpleNamespace(grid=np.arange(self.rows))

    @cached_property
    def path(self) -> SimpleNamespace:
        """Carries `nominal_wrench` (g, 6)."""
        return SimpleNamespace(nominal_wrench=self.wrench(0))


@dataclass(frozen=True, eq=False)
class TurnedView(SensorView):
    """A sensor that is turned with a load on it.

    Attributes:
        orientation: (g, 3, 3) sensor in the upright frame.
        mass: nominal or identified, kg.
        moment: (3,) first moment, mass times centre, kg m.
        identified: whether mass and moment were identified from the readings.
        found_in: frame that the readings were given in, where another one was stated; "" where none was.
    """

    excitation = "orientations"
    orientation: Array
    mass: float
    moment: Array
    identified: bool
    found_in: str = ""

    @property
    def known_frames(self) -> Sequence[Frame]:
        """Every frame: quarter turns, the orientation the other way round, the reaction."""
        return frames()

    @cached_property
    def gravity(self) -> Array:
        """(g, 3) acceleration of gravity in the stated frame, m/s^2."""
        return frames()[0].gravity(self.orientation)

    @property
    def conditions(self) -> Array:
        """(g, 9) entries of the orientation: gravity is linear in them, whatever the frame."""
        return self.orientation.reshape(-1, 9)

    def wrench(self, frame: int) -> Array:
        """Return (g, 6) nominal wrench in one of the frames; the centre is where the stated frame has it."""
        gravity = frames()[frame].gravity(self.orientation)
        return np.hstack([self.mass * gravity, np.cross(frames()[frame].turn @ self.moment, gravity)])

    def pulls(self, frame: int) -> Sequence[tuple[Array, Array]]:
        """Return forces, N, and gravity in the frame, m/s^2, (g, 3) each."""
        return [(self.reading[:, :3], frames()[frame].gravity(self.orientation))]

    def inputs(self, actuator: str) -> Array:
        """Return the direction of gravity and the share that had passed, (g, 4)."""
        return np.column_stack([self.gravity, self.elapsed])

    def load_in_words(self, mass: float, moment: Sequence[float] | Array) -> str:
        """Return the load on the sensor with a further mass, kg, and first moment (3,), kg m; nothing without load."""
        total = self.mass + mass
        if total <= 0.0:
            return ""
        centre = ", ".join(f"{1e3 * x:.1f}" for x in (self.moment + np.array(moment)) / total)
        return f"load on the sensor: {total:.4g} kg, centre ({centre}) mm in its frame"

    def in_words(self) -> list[str]:
        """Return the load as stated or identified, and what an identified one leaves open."""
        load = self.load_in_words(0.0, np.zeros(3))
        own_mass = "the mass was identified from the readings: a scale of all forces cannot be told from it"
        turned = f"the load turns as readings in the frame of the {self.found_in} do: `expressed_in: {self.found_in}`"
        return [load] * bool(load) + [own_mass] * self.identified + [turned] * bool(self.found_in)


@dataclass(frozen=True, eq=False)
class AppliedView(SensorView):
    """A sensor that stays as it is under known weights at known levers.

    Attributes:
        applied: (g, 6) nominal wrench about the sensor's origin, N and N m.
    """

    excitation = "weights"
    applied: Array

    @property
    def known_frames(self) -> Sequence[Frame]:
        """The frames without an orientation: quarter turns and the reaction."""
        return [frame for frame in frames() if not frame.inverted]

    @property
    def conditions(self) -> Array:
        """(g, 6) the applied wrench."""
        return self.applied

    def wrench(self, frame: int) -> Array:
        """Return (g, 6) applied wrench in one of the frames."""
        turn, _, sign = self.known_frames[frame]
        return sign * np.hstack([self.applied[:, :3] @ turn.T, self.applied[:, 3:] @ turn.T])

    def pulls(self, frame: int) -> Sequence[tuple[Array, Array]]:
        """Return forces and torques, (g, 3) each: weights that pull along one line alone tell no turn about it."""
        nominal = self.wrench(frame)
        return [(self.reading[:, part], nominal[:, part]) for part in (slice(0, 3), slice(3, 6))]

    def inputs(self, actuator: str) -> Array:
        """Return the applied wrench and the share that had passed, (g, 7)."""
        return np.column_stack([self.applied, self.elapsed])
