"""What an effect of the library is: where it may sit, what it adds to the residuals, and how its numbers read.

A signature is linear in its coefficients and, where need be, nonlinear in a `shape` that is searched over a few
values. That
keeps every fit a small least-squares problem whose held-out loss is exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
from sher3_description import ACTUATORS, Robot

from sher3_gap.channels import Array, Channel
from sher3_gap.geometry import Geometry, Path
from sher3_gap.library.operators import dahl
from sher3_gap.residuals import drive_law
from sher3_gap.signals import RunSignals

Shape = Mapping[str, float]


@dataclass(frozen=True)
class Signature:
    """What an effect adds to the residuals of one run.

    Attributes:
        columns: per channel (g, d, p), one column per coefficient.
        fixed: per channel (g, d), the part without a coefficient.
    """

    columns: dict[Channel, Array] = field(default_factory=dict)
    fixed: dict[Channel, Array] = field(default_factory=dict)


class View:
    """A run with its kinematics and the features that several effects share."""

    def __init__(self, run: RunSignals, robot: Robot, geometry: Geometry) -> None:
        self.run = run
        self.robot = robot
        self.geometry = geometry
        self._dahl: dict[tuple[int, float], Array] = {}

    @cached_property
    def path(self) -> Path:
        """Kinematics on the residual grid."""
        return self.geometry.path(self.run)

    @cached_property
    def velocity(self) -> Array:
        """Motor velocity on the residual grid, (g, 5)."""
        return self.run.velocity[self.run.grid]

    @cached_property
    def position(self) -> Array:
        """Smoothed motor position on the residual grid, (g, 5)."""
        return self.run.smooth[self.run.grid]

    @cached_property
    def inertial(self) -> Array:
        """Nominal force that the measured motion needs: m a + viscous v + G - tau_ext, (g, 5)."""
        mass = np.array([a.mass for a in self.robot.actuators])
        viscous = np.array([a.viscous for a in self.robot.actuators])
        moving = self.run.to_grid(mass * self.run.acceleration + viscous * self.run.velocity)
        return moving + self.path.gravity - self.path.contact_force

    @cached_property
    def warmth(self) -> Array:
        """Temperature above 22 deg C on the residual grid, (g,)."""
        if self.run.temperature is None:
            return np.zeros(len(self.run.grid))
        return self.run.temperature[self.run.grid] - 22.0

    @cached_property
    def platform(self) -> Array:
        """Platform centre in {b} on the residual grid, (g, 3)."""
        return self.geometry.platform(self.run)

    @cached_property
    def lever(self) -> Array:
        """From the platform centre to the tip in {b}, (g, 3)."""
        return self.path.position - self.platform

    @cached_property
    def links(self) -> Array:
        """Gamma (g, 6, 6): columns (u; b x u) of the six links at the platform (paper, eq. 9)."""
        return self.geometry.links(self.platform)

    @cached_property
    def link_changes(self) -> Array:
        """Change of the tip pose (g, 6, 6) per change of the length of each of the six links.

        Gamma^-T, moved to the tip.
        """
        twist = np.linalg.inv(np.swapaxes(self.links, 1, 2))
        swing = np.cross(np.swapaxes(twist[:, 3:], 1, 2), self.lever[:, None, :])
        return np.concatenate([twist[:, :3] + np.swapaxes(swing, 1, 2), twist[:, 3:]], axis=1)

    @cached_property
    def law(self) -> Array:
        """Nominal drive law just before every tick, (n, 5)."""
        assert self.run.echo is not None
        return drive_law(self.run, self.robot, self.run.echo)

    @cached_property
    def tip_acceleration(self) -> Array:
        """Acceleration of the tip in {b} at every tick, (n, 3), from the smoothed motion."""
        run, clock = self.run, self.run.stage_clock
        jacobian = self.path.jacobian[:, :3].reshape(len(run.grid), -1)
        full = np.stack([np.interp(clock, clock[run.grid], c) for c in jacobian.T], axis=1).reshape(run.ticks, 3, -1)
        return np.gradient(np.einsum("nij,nj->ni", full, run.velocity), run.period, axis=0)

    def sliding(self, axis: int, displacement: float) -> Array:
        """Dahl state of an axis, -1..1, (n,): +1 after moving forward by a few `displacement`."""
        key = (axis, displacement)
        if key not in self._dahl:
            self._dahl[key] = dahl(self.run.smooth[:, axis], displacement)
        return self._dahl[key]

    def tip_channels(self) -> tuple[Channel, ...]:
        """The channels on which the tip pose is seen."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def at_tip(self, columns: Array) -> dict[Channel, Array]:
        """The same (g, 6, p) columns on the tip channels; empty without a tracker."""
        if self.run.tracker_position is None:
            return {}
        return {c: columns for c in self.tip_channels()}


class LibraryEffect:
    """Base of the library's effects; a subclass is one small file.

    Class attributes:
        id, family, stage: of the recorded-run contract, §7.
        explanation: plain language: what it is and how it shows.
        siblings: effect id -> what tells it apart.
        extends: ids of simpler effects that this one contains; it must explain markedly more than they do.
        units: parameter -> SI unit on a linear axis.
    """

    id: ClassVar[str]
    family: ClassVar[str]
    stage: ClassVar[str]
    explanation: ClassVar[str]
    siblings: ClassVar[Mapping[str, str]] = {}
    extends: ClassVar[tuple[str, ...]] = ()
    units: ClassVar[Mapping[str, str]] = {}

    def sites(self) -> tuple[str, ...]:
        """Actuators (or `tip`, `force_sensor`, `all`) the effect may sit on."""
        return ACTUATORS

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Channels in which the effect must show to be looked for there."""
        return (Channel(self.stage, site),)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Nonlinear parameters to search over."""
        return [{}]

    def refine(self, shape: Shape) -> list[Shape]:
        """Neighbours of the best shape for a second, finer search."""
        return []

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """What the effect adds to the residuals of one run."""
        raise NotImplementedError

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Physical parameters of a fit, SI."""
        raise NotImplementedError

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Whether a fit is physically possible."""
        return True

    def unlikely(self, shape: Shape, coefficients: Array) -> bool:
        """Whether a fit, though possible, is what another effect would rather be called."""
        return False

    def unit(self, name: str, site: str) -> str:
        """Unit of a parameter; roll is rotary where a linear axis counts in m or N."""
        unit = self.units.get(name, "1")
        if site != "roll":
            return unit
        return {"m": "rad", "N": "N*m", "N/(m/s)": "N*m/(rad/s)", "m/s": "rad/s", "N/m": "N*m/rad"}.get(unit, unit)


def axis_of(site: str) -> int:
    """Index of an actuator."""
    return ACTUATORS.index(site)


def lead(view_or_robot: View | Robot, site: str) -> float:
    """Travel of an actuator per motor revolution, m or rad."""
    robot = view_or_robot.robot if isinstance(view_or_robot, View) else view_or_robot
    return robot.actuators[axis_of(site)].lead


def column(*parts: Array) -> Array:
    """Stack (g,) columns into (g, 1, p)."""
    return np.stack(parts, axis=-1)[:, None, :]
