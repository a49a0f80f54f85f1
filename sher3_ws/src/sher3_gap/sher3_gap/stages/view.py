"""A run of the robot as the effects and the engine see it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.discover.feature import Quantities
from sher3_diagnosis.evidence import Motion
from sher3_diagnosis.filter import DECIMATED_RATE
from sher3_effects.motion import GridView
from sher3_effects.operators import dahl
from sher3_effects.view import NominalAxis

from sher3_gap.signals import RunSignals
from sher3_gap.stages.geometry import Geometry, Path
from sher3_gap.stages.quantities import everything, quantities
from sher3_gap.stages.recorded import recorded_at
from sher3_gap.stages.residuals import drive_law


class SherView(GridView):
    """A run of the robot with its kinematics and the features that several effects share."""

    holds_at_rest = True

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
        return self.run.temperature[self.run.grid] - REFERENCE_TEMPERATURE

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

    # what the engine reads

    @property
    def rate(self) -> float:
        """Samples per second of the residual grid, Hz."""
        return DECIMATED_RATE

    @property
    def loaded(self) -> Mask:
        """(g,) True where a known load acts on the tip."""
        return self.path.loaded

    @cached_property
    def speed_share(self) -> Array:
        """Norm of the axes' shares of their top speeds, (g,)."""
        top = np.array([a.limits.velocity for a in self.robot.actuators])
        return np.linalg.norm(self.velocity / top, axis=1)

    def row(self, site: str) -> int:
        """Return the column of an actuator."""
        return ACTUATORS.index(site)

    def axis(self, site: str) -> NominalAxis:
        """Return the nominal constants of an actuator."""
        a = self.robot.actuators[self.row(site)]
        return NominalAxis(a.mass, a.viscous, a.lead, a.limits.velocity, seen=a.motor_encoder)

    def lead(self, site: str) -> float:
        """Return the travel of an actuator per motor revolution, m or rad."""
        return self.axis(site).lead

    def motion(self, actuator: str) -> Motion | None:
        """Return the motion of an actuator; None for the tip and the force sensor."""
        if actuator not in ACTUATORS:
            return None
        i, nominal = self.row(actuator), self.axis(actuator)
        return Motion(self.position[:, i], self.velocity[:, i], nominal.top, nominal.lead)

    # what discovery reads

    def recorded(self, channel: Channel) -> Quantities:
        """Return what was recorded that the law of a gap in a channel might depend on, at every tick."""
        return recorded_at(self, channel)

    def quantities(self, site: str) -> dict[str, Array]:
        """Return what a place feels of the quantities (g,) that laws may depend on, by name, SI units."""
        return quantities(self, site)

    def everything(self) -> Array:
        """Return (g, k) everything that was recorded of the robot, with its past; computed once."""
        return self._everything

    @cached_property
    def _everything(self) -> Array:
        return everything(self)
