"""A run of one axis with its nominal forces, as the effects and the engine see it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.filter import EDGE, settled
from sher3_diagnosis.localise.readings import noise_of
from sher3_effects.operators import second_difference
from sher3_effects.view import NominalAxis

from sher3_chain.chain.view import AROUND_STOP, BUILDS_UP, LEAD_OF_STROKE, SLIP, ChainView, Loads
from sher3_chain.joint.description import Axis
from sher3_chain.readings.orders import orders_in
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import SLOW

SEEN = 5.0
"""Standard deviations of a noise that nothing passes by chance."""
STIRRING = 0.01
"""Share of the travel above which a change is no noise: what a slow record moves by is not taken for one."""
SPREAD = 0.5
"""Periods of the cut-off by which the filter spreads a step."""
REST_SPREADS = 2
"""Samples of the grid by which the filter spreads what friction does at rest, and in motion: 0.8 of a period of the
cut-off. By one sample a stop of a finely resolved axis still leaves thousands of floors."""
STRAIGHT = 1e-3
"""Share of an effort's power that a line over the place leaves of a controller's: an inertia leaves far more."""
ENOUGH = 0.5
"""Share of the samples that must be in motion, or away from such reversals, for the others to be left out."""


class AxisView(ChainView):
    """A run of one axis with its nominal forces.

    Attributes:
        described: the axis as its description has it.
        mass: nominal mass, or the one identified, kg or kg m^2.
        load_mass: part of it that moves with the second encoder.
    """

    def __init__(self, run: AxisSignals, axis: Axis, mass: float, load_mass: float = 0.0) -> None:
        super().__init__(run, [axis])
        self.described = axis
        self.mass = mass
        self.load_mass = load_mass

    # what the effects read

    def axis(self, site: str) -> NominalAxis:
        """Return the nominal constants of the axis."""
        return self._nominal

    @cached_property
    def _nominal(self) -> NominalAxis:
        axis, known = self.described, self.described.lead is not None
        travel = float(np.ptp(self.run.smooth))
        return NominalAxis(
            self.mass,
            max(axis.viscous, SLIP),
            self.lead(axis.name),
            float(self.tops[0]),
            travel,
            self.hangs,
            known,
            self.load_mass,
            axis.motion == "rotary",
            max(axis.encoder_resolution, self.noise),
            axis.effort_is_demand,
        )

    @property
    def hangs(self) -> bool:
        """Whether the axis turns and nothing is said of a weight at an arm, nor hides one."""
        return self.described.swings and not self.fed_back

    @cached_property
    def fed_back(self) -> bool:
        """Whether the effort in motion is a straight line of the place that falls: the answer of a controller.

        About one set-point it is exact, and hides what the place itself asks for: with a spring or a weight beside it,
        a force balance is met by the mirror image of the controller, and tells no mass.
        """
        run, ok = self.run, self.in_fast_motion
        if run.effort is None or ok.sum() < 2:
            return False
        q, u = self.position[ok, 0], run.to_grid(run.effort)[ok, 0]
        q, u = q - q.mean(), u - u.mean()
        return bool(q @ u < 0.0 and u @ u - (q @ u) ** 2 / (q @ q) < STRAIGHT * (u @ u))

    def lead(self, site: str) -> float:
        """Return the travel per motor revolution, m or rad; what stands for it where it is not known."""
        if self.described.lead is not None:
            return self.described.lead
        if self.described.motion == "rotary":
            return 2.0 * np.pi
        return LEAD_OF_STROKE * max(float(np.ptp(self.run.motor)), self.described.encoder_resolution)

    def orders(self, site: str, count: int) -> list[float]:
        """Return the waves over the position that stand out between two encoders, the strongest first.

        Args:
            site: the axis.
            count: of them at most; in periods per turn, or per 2 pi m of an axis that slides.
        """
        run, row = self.run, self.row(site)
        if run.load is None:
            return []
        apart, ok = run.to_grid(run.load - run.motor)[:, row], run.inner
        return orders_in(apart[ok], self.position[ok, row], self.velocity[ok, row], count)

    @cached_property
    def path(self) -> Loads:
        """Nominal weight along the motion, and the known force from outside.

        The sine goes through the filter as the acceleration does: that of a filtered angle is another one.
        """
        law = self.described.gravity
        weight = self.run.to_grid(law.constant + law.arm * np.sin(self.run.motor - law.hanging))
        applied = self.run.applied
        return Loads(weight, np.zeros_like(weight) if applied is None else self.run.to_grid(applied))

    @cached_property
    def inertial(self) -> Array:
        """Nominal force that the motion needs, (g, 1): mass * a + viscous * v + weight + the user's own model."""
        run, viscous = self.run, max(self.described.viscous, SLIP)
        needed = run.to_grid(self.mass * run.acceleration + viscous * run.velocity) + self.path.gravity
        if self.load_mass:
            needed = needed + self.load_mass * self.behind
        return needed if run.nominal is None else needed + run.to_grid(run.nominal)

    @cached_property
    def thick(self) -> float:
        """Viscous friction, N/(m/s) or N m/(rad/s): the nominal one, or what would carry the force in motion alone."""
        run, ok, nominal = self.run, self.in_motion, self.described.viscous
        pace = self.velocity[ok, 0]
        if run.effort is None or not pace.any():
            return nominal
        return max(nominal, float(abs(pace @ run.to_grid(run.effort)[ok, 0]) / (pace @ pace)))

    @cached_property
    def behind(self) -> Array:
        """Acceleration of the second encoder less that of the first, (g, 1); zero where there is one encoder."""
        run = self.run
        if run.load is None:
            return np.zeros((len(run.grid), 1))
        return np.asarray(run.to_grid(second_difference(run.load, run.period)) - self.acceleration)

    # which samples can be judged

    @cached_property
    def moving(self) -> Mask:
        """(g,) True where the axis moves: at rest friction takes any value, and the force balance says nothing."""
        least = max(self.described.encoder_resolution, self._jitter)
        return self.moves(np.array([least]))[:, 0]

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the encoder's noise, or of rounding to its count, m or rad."""
        return noise_of(self.run.motor[:, 0], self.described.encoder_resolution)

    @cached_property
    def _jitter(self) -> float:
        """Change of the smoothed position that the encoder's noise makes, m or rad; a small part of the travel."""
        run = self.run
        white = np.random.default_rng(0).normal(size=(run.ticks, 1))
        left = self.noise * float(run.filtered(white).std())
        return min(SEEN * left, STIRRING * float(np.ptp(run.smooth)))

    @cached_property
    def released(self) -> Mask:
        """(g,) False for an undriven axis until the filter has forgotten what held it before it was let go."""
        if not self.described.free:
            return np.ones(len(self.run.grid), dtype=bool)
        smeared = self.run.edge - EDGE / self.run.period  # what a lower cut-off than the engine's spoils more
        return self.run.grid >= self.release + max(smeared, 0.0)

    @cached_property
    def release(self) -> int:
        """Sample of the record at which the motion in one direction with the largest travel begins."""
        way = np.sign(self.velocity[:, 0]) * self.moving
        turns = np.flatnonzero(np.diff(np.concatenate([[0.0], way, [0.0]])))
        if not len(turns):
            return 0
        travel = np.abs(np.diff(self.position[np.minimum(turns, len(way) - 1), 0]))
        return int(self.run.grid[turns[int(np.argmax(travel * np.abs(way[turns[:-1]])))]])

    @cached_property
    def in_motion(self) -> Mask:
        """(g,) True where the force balance can be judged: well inside a stretch of motion."""
        limited = self.run.limited
        moves = self.moving & settled(~self.at_a_stop, AROUND_STOP)
        moves = moves if limited is None else moves & ~limited[self.run.grid]
        inside = self.run.inner & self.released & settled(moves, REST_SPREADS)
        clear, by_force = inside & self.clear, not (self.described.free or self.described.servo)
        return clear if clear.sum() >= ENOUGH * inside.sum() and by_force else inside

    @cached_property
    def in_fast_motion(self) -> Mask:
        """(g,) True where the axis moves fast enough for friction to have its sign and to be built up."""
        speed, ok = np.abs(self.velocity[:, 0]), self.in_motion
        return ok & (speed > SLOW * np.sqrt(np.mean(speed[ok] ** 2))) if ok.any() else ok

    @cached_property
    def direction(self) -> Array:
        """Sense of the motion (g,), as dry friction has it: it builds up over a part of the lead, or of the travel."""
        nominal = self._nominal
        over = nominal.lead if nominal.lead_known else LEAD_OF_STROKE * nominal.travel
        reach = max(BUILDS_UP * over, self.described.encoder_resolution)
        return np.asarray(self.run.to_grid(self.sliding(0, reach)[:, None])[:, 0])

    @cached_property
    def at_a_stop(self) -> Mask:
        """(g,) True where the axis is at an end of its stated range: a stop pushes it back there."""
        ranges = np.array([self.described.range or (-np.inf, np.inf)])
        return self.beyond(self.position, ranges)[:, 0]

    @property
    def mostly_moves(self) -> bool:
        """Whether the axis is in motion for most of the record."""
        return bool(self.in_motion.sum() >= ENOUGH * self.run.inner.sum())

    @cached_property
    def clear(self) -> Mask:
        """(g,) False about a reversal that the samples pass over by more than a count: friction turns in between.

        A count, or the noise. Half a sample more or less then is the whole step of the friction, spread by the filter.
        """
        run = self.run
        pace, turn = run.velocity[:, 0], np.gradient(run.velocity[:, 0])
        seen = max(self.described.encoder_resolution, self.noise)
        at = np.flatnonzero((pace[1:] * pace[:-1] < 0.0) & (run.period * np.abs(turn[1:]) > seen))
        reach = SPREAD / (run.bandwidth * run.period)
        near = np.searchsorted(at, run.grid)
        after = run.grid - np.concatenate([[-np.inf], at + 0.5])[near]
        before = np.concatenate([at + 0.5, [np.inf]])[near] - run.grid
        return np.asarray(np.minimum(after, before) > reach)

    @cached_property
    def at_rest(self) -> Mask:
        """(g,) True well inside a stretch without motion."""
        return self.run.inner & self.released & settled(~self.moving, REST_SPREADS)

    # what the engine reads

    def quantities(self, site: str) -> dict[str, Array]:
        """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns, as the axis feels them.

        The force is the one that the motion needs; where no mass is known and no force balance judged, the recorded
        one. Of a body that nothing drives neither it nor the acceleration is a cause: what is judged is made of them.
        """
        run, felt = self.run, self.travelled(0)
        if run.effort is not None and not run.effort.any():
            return felt
        needed = self.inertial
        if not self.mass and run.effort is not None and run.nominal is None:
            needed = run.to_grid(run.effort)
        past = self.gone_through(needed[:, 0])
        return felt | {"acceleration": self.acceleration, "force": needed, "loading": past}
