"""What a user's command carries, whatever delivers it: the samples of the runtime fit these without being imported."""

from __future__ import annotations

from typing import Protocol

from .modes import Vector


class JointCommand(Protocol):
    """Actuator positions and velocities (5,) for the tick of `stamp` [ns]."""

    @property
    def stamp(self) -> int:
        """The tick it is for [ns]."""

    @property
    def position(self) -> Vector | None:
        """(5,) m and rad, or absent."""

    @property
    def velocity(self) -> Vector | None:
        """(5,) m/s and rad/s, or absent."""


class TwistCommand(Protocol):
    """A tip twist (6,) in {b}."""

    @property
    def stamp(self) -> int:
        """The tick it is for [ns]."""

    @property
    def twist(self) -> Vector:
        """Linear [m/s], then angular [rad/s]."""


class PoseCommand(Protocol):
    """A tip pose in {b}."""

    @property
    def stamp(self) -> int:
        """The tick it is for [ns]."""

    @property
    def position(self) -> Vector:
        """(3,) m."""

    @property
    def orientation(self) -> Vector:
        """Unit quaternion (x, y, z, w)."""
