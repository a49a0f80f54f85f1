"""A run of a chain of joints as the effects and the engine see it: its motion, and what was recorded beside it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.discover.feature import Quantities, Quantity
from sher3_diagnosis.evidence import Motion
from sher3_diagnosis.filter import DECIMATED_RATE, EDGE
from sher3_effects.motion import GridView
from sher3_effects.operators import dahl_turned

from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import HELD

LEAD_OF_STROKE = 0.02
"""Share of the stroke that replaces the lead of a linear axis where it is not known. Effects search displacements in
shares of the lead; of a turning axis one turn stands for it."""
BUILDS_UP = 2.5e-3
"""Share of the lead over which dry friction builds up after a reversal: the middle one that the effects search."""
QUARTER = 0.5 * np.pi
"""A quarter turn, rad."""
SLIP = 1e-9
"""Viscous coefficient in place of none, N/(m/s) or N m/(rad/s): effects take it as a scale."""
REFERENCE = 20.0
"""Temperature, deg C, at which lengths are stated (ISO 1)."""
STILL = 1e-12
"""Top speed in place of none, m/s or rad/s: shares of the top speed are taken."""
CREEPS = 0.01
"""Share of the top speed of a slow motion: a slower one cannot be distinguished from a stop."""
TURNS_BY = 4.0
"""Counts by which a turn differs from a stop: fewer are rounding."""

PAST = (0.003, 0.03, 0.3)
"""Shares of a range over which a state forgets: what went before within a fine, a usual and a coarse stroke."""
AROUND_STOP = round(EDGE * DECIMATED_RATE)
"""Samples of the residual grid around one at a stop: the filter spoils as much of it as of the ends of a run."""
MOSTLY = 0.9
"""Share of a record beyond its range from which a joint has another zero than its model."""


class Loads(NamedTuple):
    """Nominal loads on the residual grid, (g, n) each, N or N m.

    Attributes:
        gravity: weight on every joint.
        contact_force: known force from outside, positive along the motion; zero where none was recorded.
    """

    gravity: Array
    contact_force: Array


class ChainView(GridView, ABC):
    """A run of n joints; signals have a column for each of them.

    Attributes:
        run: signals of the joints.
        joints: as described.
    """

    def __init__(self, run: AxisSignals, joints: Sequence[Axis]) -> None:
        self.run = run
        self.joints = joints
        self._rows = {joint.name: row for row, joint in enumerate(joints)}
        self._sliding: dict[tuple[int, float], Array] = {}

    # what the effects read

    def row(self, site: str) -> int:
        """Return the column of a joint."""
        return self._rows[site]

    def sliding(self, axis: int, displacement: float) -> Array:
        """Return the Dahl state of a joint, -1..1, (n,): +1 after moving forward by a few `displacement`, m or rad."""
        if (axis, displacement) not in self._sliding:
            path, pace = (np.ascontiguousarray(x[:, axis]) for x in (self.run.smooth, self.run.velocity))
            self._sliding[axis, displacement] = dahl_turned(path, pace, displacement, self.run.period)
        return self._sliding[axis, displacement]

    @cached_property
    @abstractmethod
    def path(self) -> Loads:
        """Nominal weight on every joint along the motion, and known forces from outside."""

    @cached_property
    @abstractmethod
    def inertial(self) -> Array:
        """Nominal force that the measured motion needs, (g, n)."""

    # what the engine reads

    @property
    def rate(self) -> float:
        """Samples per second of the residual grid, Hz."""
        return self.run.rate

    @cached_property
    def tops(self) -> Array:
        """Largest velocity of every joint, (n,)."""
        return np.maximum(np.abs(self.run.velocity).max(axis=0), STILL)

    @cached_property
    def speed_share(self) -> Array:
        """(g,) speed of the fastest joint over its largest of the run."""
        return (np.abs(self.velocity) / self.tops).max(axis=1)

    @property
    def loaded(self) -> Mask:
        """(g,) True where a known force from outside acts."""
        return np.asarray((self.path.contact_force != 0.0).any(axis=1))

    @cached_property
    def warmth(self) -> Array:
        """(g,) temperature above the reference, K; zero where it was not recorded."""
        warm = self.run.temperature
        return np.zeros(len(self.run.grid)) if warm is None else self.run.to_grid(warm - REFERENCE)[:, 0]

    def motion(self, actuator: str) -> Motion | None:
        """Return the motion of a joint; None for a link."""
        if actuator not in self._rows:
            return None
        row = self.row(actuator)
        return Motion(self.position[:, row], self.velocity[:, row], float(self.tops[row]), self.joints[row].lead)

    def travelled(self, row: int) -> dict[str, Array]:
        """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns that any joint feels of its motion.

        The past of a path is in Dahl states, which turn over a share of what it goes through; so is that of a force.
        """
        run = self.run
        travel = max(float(np.ptp(run.smooth[:, row])), self.joints[row].encoder_resolution)
        return {
            "position": self.position[:, [row]],
            "velocity": self.velocity[:, [row]],
            "direction": np.column_stack([self.sliding(row, share * travel)[run.grid] for share in PAST]),
            "load": self.path.contact_force[:, [row]],
            "temperature": self.warmth[:, None],
        }

    def gone_through(self, force: Array) -> Array:
        """Return (g, 3) Dahl states of a force (g,) on a joint."""
        run = self.run
        force = np.interp(run.stage_clock, run.stage_clock[run.grid], force)
        reach, pace = float(np.ptp(force)) or 1.0, np.gradient(force, run.period)
        return np.column_stack([dahl_turned(force, pace, share * reach, run.period)[run.grid] for share in PAST])

    def moves(self, least: Array) -> Mask:
        """Return (g, n) where each joint moves by more than `least` (n,), m or rad, around a sample of the grid.

        The filter lets a joint creep that has come to rest, and hides a stop between two samples: by its raw readings,
        too, it must not stop.
        """
        run, half = self.run, max(1, self.run.stride)
        before, after = np.maximum(run.grid - half, 0), np.minimum(run.grid + half, run.ticks - 1)
        stops = np.column_stack([self._stops(row) for row in range(len(self.joints))])
        return np.asarray((np.abs(run.smooth[after] - run.smooth[before]) > least) & ~stops)

    def beyond(self, position: Array, ranges: Array) -> Mask:
        """Return (g, n) where joints are at or beyond the ends of their ranges (n, 2), by a count: a stop is there.

        A joint that lies beyond for most of a record has another zero, and no stop there.
        """
        low, high = ranges.T
        counts = np.array([joint.encoder_resolution for joint in self.joints])
        out = (position < low + counts) | (position > high - counts)
        return np.asarray(out & (out.mean(axis=0) < MOSTLY))

    def _stops(self, row: int) -> Mask:
        """Return (g,) where the readings of a joint stay for as long as a slow motion, or a turn, takes to pass counts.

        A turn at the usual acceleration passes `TURNS_BY` counts on either side of it within that time.
        """
        run, count = self.run, self.joints[row].encoder_resolution
        bend = float(np.sqrt(np.mean(np.gradient(run.velocity[:, row], run.period) ** 2))) or STILL
        time = max(count / (CREEPS * self.tops[row]), float(np.sqrt(2.0 * TURNS_BY * count / bend)))
        window = 2 * int(np.clip(np.ceil(time / run.period), 1, max(1, run.stride))) + 1
        readings = run.motor[:, row]
        stays = maximum_filter1d(readings, window) - minimum_filter1d(readings, window) < 0.5 * count
        return np.asarray(maximum_filter1d(stays, 2 * (run.stride // 2) + 1)[run.grid])

    # what discovery reads

    def recorded(self, channel: Channel) -> Quantities:
        """Return what was recorded that the law of a gap of a joint might depend on; not the effort, the output."""
        run, row, joint = self.run, self.row(channel.actuator), self.joints[self.row(channel.actuator)]
        unit, newton = joint.unit_of_position, joint.unit_of_force
        need, weight = (
            np.interp(run.stage_clock, run.stage_clock[run.grid], x[:, row]) for x in (self.inertial, self.path.gravity)
        )
        acceleration = np.gradient(run.velocity[:, row], run.period)
        return {
            "position": Quantity(run.smooth[:, row], unit, "the position", "place"),
            "velocity": Quantity(run.velocity[:, row], f"{unit}/s", "the velocity", "speed"),
            "acceleration": Quantity(acceleration, f"{unit}/s^2", "the acceleration", "state"),
            "force": Quantity(need, newton, "the force that the motion needs", "force"),
            "load": Quantity(weight, newton, "the weight on the joint", "force"),
            "time": Quantity(run.stage_clock, "s", "the time since the run began", "clock"),
        }


def held_beside(travels: Sequence[float], motions: Sequence[str]) -> Mask:
    """Return (n,) which joints are held while another of their kind moves far, given what each travels, m or rad.

    A joint that turns on and on counts for a quarter turn: how far a controller gives way does not grow with it.
    """
    far = np.array([min(t, QUARTER) if motion == "rotary" else t for t, motion in zip(travels, motions, strict=True)])
    widest = np.array([max(far[[other == motion for other in motions]]) for motion in motions])
    return np.asarray(far < HELD * widest)
