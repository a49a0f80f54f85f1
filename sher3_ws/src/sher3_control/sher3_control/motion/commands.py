"""What a motion mode needs to know of a user's command.

These are protocols: the samples of `sher3_common.samples` fit them, and so does any other object with these fields.
"""

from __future__ import annotations

from typing import Protocol

from sher3_common.vectors import Vector


class JointCommand(Protocol):
    """Actuator positions and velocities (5,) for the tick of `stamp` [ns]."""

    @property
    def stamp(self) -> int:
        """The tick that the command is for [ns]."""

    @property
    def position(self) -> Vector | None:
        """(5,) m and rad; None where the message has none."""

    @property
    def velocity(self) -> Vector | None:
        """(5,) m/s and rad/s; None where the message has none."""


class TwistCommand(Protocol):
    """A tip twist (6,) in {b}."""

    @property
    def stamp(self) -> int:
        """The tick that the command is for [ns]."""

    @property
    def twist(self) -> Vector:
        """Linear [m/s], then angular [rad/s]."""


class PoseCommand(Protocol):
    """A tip pose in {b}."""

    @property
    def stamp(self) -> int:
        """The tick that the command is for [ns]."""

    @property
    def position(self) -> Vector:
        """(3,) m."""

    @property
    def orientation(self) -> Vector:
        """Unit quaternion (x, y, z, w)."""
