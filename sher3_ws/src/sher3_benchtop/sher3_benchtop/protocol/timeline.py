"""A test as a table: the command and the load of every tick, and when the cameras take their pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Mode = Literal["servo_cp", "servo_jp"]


class Picture(NamedTuple):
    """One picture.

    Attributes:
        tick: when it is taken.
        group: a plane (`xz`, `yz`), an axis (`roll`, `tilt`), or `x0` for a push along x at place 0.
        target: commanded place in that group, in its own numbering.
        force: at the grasping point [N], along the axis of the push.
    """

    tick: int
    group: str
    target: int
    force: float = 0.0


@dataclass(frozen=True)
class Timeline:
    """One test.

    Attributes:
        name: of the test.
        mode: of the commands.
        commands: tip positions (n, 3) [m] in {b} at constant orientation, or actuator positions (n, 5).
        forces: at the grasping point (n, 3) [N].
        pictures: in the order of their ticks.
    """

    name: str
    mode: Mode
    commands: Floats
    forces: Floats
    pictures: list[Picture]

    def __len__(self) -> int:
        return len(self.commands)


def minimum_jerk(ticks: int) -> Floats:
    """Return the course (ticks,) of a minimum-jerk motion from 0 (left out) to 1 (Flash and Hogan 1985, eq. 4)."""
    s = np.arange(1, ticks + 1) / ticks
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


@dataclass
class Builder:
    """Writes a timeline motion by motion, from `place` (3,) or (5,) on.

    Attributes:
        period: of a tick [s].
        dwell: rest before a picture [s]; the host law's time constant is 50 ms, so the lag has decayed by e^-8.
    """

    place: Floats
    period: float
    dwell: float
    _commands: list[Floats] = field(default_factory=list)
    _forces: list[Floats] = field(default_factory=list)
    _pictures: list[Picture] = field(default_factory=list)
    _force: Floats = field(default_factory=lambda: np.zeros(3))
    _tick: int = 0

    def move(self, goal: ArrayLike, seconds: float) -> None:
        """Move to `goal` in `seconds`."""
        course = minimum_jerk(self._ticks(seconds))[:, None]
        start, self.place = self.place, np.asarray(goal, dtype=float)
        self._extend(start + course * (self.place - start), np.tile(self._force, (len(course), 1)))

    def push(self, force: ArrayLike, seconds: float = 0.1) -> None:
        """Change the force at the grasping point to `force` (3,) [N] in `seconds`."""
        course = minimum_jerk(self._ticks(seconds))[:, None]
        start, self._force = self._force, np.asarray(force, dtype=float)
        self._extend(np.tile(self.place, (len(course), 1)), start + course * (self._force - start))

    def picture(self, group: str, target: int, force: float = 0.0) -> None:
        """Rest, and take a picture at the end."""
        ticks = self._ticks(self.dwell)
        self._extend(np.tile(self.place, (ticks, 1)), np.tile(self._force, (ticks, 1)))
        self._pictures.append(Picture(self._tick - 1, group, target, force))

    def build(self, name: str, mode: Mode) -> Timeline:
        """Return the timeline."""
        return Timeline(name, mode, np.vstack(self._commands), np.vstack(self._forces), self._pictures)

    def _ticks(self, seconds: float) -> int:
        return max(1, round(seconds / self.period))

    def _extend(self, commands: Floats, forces: Floats) -> None:
        self._commands.append(commands)
        self._forces.append(forces)
        self._tick += len(commands)
