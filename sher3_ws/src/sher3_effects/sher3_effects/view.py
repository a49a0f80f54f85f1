"""What the law of an effect sees of a run: the motion of an axis, and for a robot its kinematics and loads.

A machine hands its own object to the pages; these protocols say which facts a page may ask it for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Mask


class NominalAxis(NamedTuple):
    """Nominal constants of one axis.

    Attributes:
        mass: moving mass, kg, or inertia, kg m^2.
        viscous: viscous coefficient, N/(m/s) or N m/(rad/s).
        lead: travel per motor revolution, m or rad.
        top: largest velocity, m/s or rad/s.
        travel: span of the positions of the run, m or rad; 0 where nothing asks for it.
        weighed: whether a turning axis may carry a weight on a lever that its description does not state.
        lead_known: whether `lead` is stated, not assumed.
        rotary: whether the axis turns.
        load_mass: part of the mass that moves with a second encoder, kg or kg m^2; 0 where it is not known.
        seen: one count of the encoder or its noise, the larger, m or rad; 0 where nothing asks for it.
        effort_is_demand: whether its effort is what the drive was told, a voltage or a duty, and no force yet.
        follows: gain of the servo whose law stands for an effort that nobody recorded, N/m or N m/rad; 0: another.
        of_step: inertia that a simulator's step adds to what the effort moves, kg or kg m^2: no gain multiplies it.
    """

    mass: float
    viscous: float
    lead: float
    top: float
    travel: float = 0.0
    weighed: bool = False
    lead_known: bool = True
    load_mass: float = 0.0
    rotary: bool = False
    seen: float = 0.0
    effort_is_demand: bool = False
    follows: float = 0.0
    of_step: float = 0.0


class StatedLaw(NamedTuple):
    """The command that a description states, part by part, at every sample; in units of the command.

    Attributes:
        error: reference less reading, (n,), m or rad.
        parts: of position, speed and integral, (n, 3); the law is their sum.
        limit: largest command.
        gain: of the error, command per m or rad.
    """

    error: Array
    parts: Array
    limit: float
    gain: float

    @property
    def command(self) -> Array:
        """Return what the law asks for, (n,)."""
        return self.clipped(self.parts.sum(axis=1))

    def clipped(self, command: Array) -> Array:
        """Return a command (n,) within its limit."""
        return np.clip(command, -self.limit, self.limit)


class LawView(Protocol):
    """A run of one axis with the law that its command was stated to follow."""

    run: Any
    """Signals of the run: see `sher3_effects.motion.FilteredRun`."""

    stated: StatedLaw
    """The stated law on what was recorded."""


class AxisView(Protocol):
    """A run of one or more axes with their nominal forces; all that an effect of an axis needs."""

    run: Any
    """Signals of the run: see `sher3_effects.motion.FilteredRun`."""
    holds_at_rest: bool
    """Whether a dry friction holds any force up to its level in samples at rest."""

    def row(self, site: str) -> int:
        """Return the column of an actuator in the run's arrays."""

    def axis(self, site: str) -> NominalAxis:
        """Return the nominal constants of an axis."""

    def lead(self, site: str) -> float:
        """Return the travel of an axis per motor revolution, m or rad."""

    def sliding(self, axis: int, displacement: float) -> Array:
        """Return the Dahl state of an axis, -1..1, (n,): +1 after moving forward by a few `displacement`."""

    @property
    def path(self) -> Any:
        """Kinematics and nominal loads on the residual grid."""

    @property
    def position(self) -> Array:
        """Smoothed motor position on the residual grid, (g, axes)."""

    @property
    def velocity(self) -> Array:
        """Motor velocity on the residual grid, (g, axes)."""

    @property
    def acceleration(self) -> Array:
        """Motor acceleration on the residual grid, (g, axes)."""

    @property
    def inertial(self) -> Array:
        """Nominal force that the measured motion needs, (g, axes)."""

    @property
    def warmth(self) -> Array:
        """Temperature above the reference on the residual grid, (g,), K; zero where it was not recorded."""

    @property
    def loaded(self) -> Mask:
        """(g,) True where a load acts."""


def without_force(views: Sequence[AxisView]) -> bool:
    """Return whether no force was recorded: of a drive, which an axis that is let go has none of, or from outside."""
    efforts = [v.run.effort for v in views]
    return all(x is None or not x.any() for x in efforts) and not any(v.path.contact_force.any() for v in views)


class ArmMotionView(AxisView, Protocol):
    """A run of a serial arm whose model is known: what an effect that several joints feel needs."""

    def payload(self, link: str, centre: tuple[float, float, float]) -> dict[str, Array]:
        """Return joint -> (g, 4) force per kg at the joint of a link, and per kg m of its centre along x, y and z.

        Args:
            link: that carries the payload.
            centre: at which its inertia is reckoned, m, in the frame of the link's joint.
        """

    def link(self, link: str) -> dict[str, Array]:
        """Return joint -> (g,) force that a link, as its model has it, needs of every joint."""

    def per_inertial(self, link: str) -> dict[str, Array]:
        """Return joint -> (g, 10) force per inertial parameter of a link, about its joint, as Pinocchio orders them."""

    def orders(self, joint: str, count: int) -> list[float]:
        """Return at most `count` periods per turn: the highest peaks in the spectrum of a joint's effort residual."""


class RobotView(AxisView, Protocol):
    """A run of the robot with its geometry: what an effect between the encoders and the tip needs."""

    robot: Any
    geometry: Any

    @property
    def platform(self) -> Array:
        """Platform centre in {b} on the residual grid, (g, 3)."""

    @property
    def lever(self) -> Array:
        """From the platform centre to the tip in {b}, (g, 3)."""

    @property
    def links(self) -> Array:
        """Gamma (g, 6, 6): columns (u; b x u) of the six links at the platform (paper, eq. 9)."""

    @property
    def link_changes(self) -> Array:
        """Change of the tip pose (g, 6, 6) per change of the length of each of the six links."""

    @property
    def law(self) -> Array:
        """Nominal drive law just before every tick, (n, 5)."""

    @property
    def tip_acceleration(self) -> Array:
        """Acceleration of the tip in {b} at every tick, (n, 3), from the smoothed motion."""

    def tip_channels(self) -> tuple[Channel, ...]:
        """Return the channels on which the tip pose is seen."""

    def at_tip(self, columns: Array) -> dict[Channel, Array]:
        """Return the same (g, 6, p) columns on the tip channels; empty without a tracker."""


class Postures(Protocol):
    """Joint frames of a serial arm at n postures, in the base frame.

    Attributes:
        frames: (n, k, 4, 4) frames of the k joints before their turn.
        axes: (n, k, 3) unit vectors along the joint axes.
    """

    frames: Array
    axes: Array


class ArmView(Protocol):
    """Postures of a serial arm as the measuring system sees them."""

    postures: Postures
    """The nominal joint frames."""

    def row(self, site: str) -> int:
        """Return the number of a joint, from 0 at the base."""

    def own_axis(self, site: str) -> Array:
        """Return the axis of a joint in its own frame, a unit vector (3,)."""

    def place(self, site: str) -> Array:
        """Return where a joint is in the base frame, (n, 3), m."""

    def carried(self, site: str) -> tuple[Array, Array]:
        """Return what a joint carries, in the base frame: the flange, and the middle of the links (n, 3) each, m."""

    def turned(self, axis: Array, through: Array) -> Array:
        """Return the pose change (n, 6) per rad of a turn about `axis` (n, 3) through a point (n, 3), base frame."""

    def shifted(self, direction: Array) -> Array:
        """Return the pose change (n, 6) per m along `direction` (n, 3) in the base frame."""
