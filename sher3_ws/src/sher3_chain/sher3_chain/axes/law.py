"""The recorded command against the law that its description states: an exact stage, judged by itself.

The law needs no model of the machine: reference and reading in, command out. Nobody states how a controller takes its
speed from its encoder, nor at which sample within a period it reads; of the usual ways that one is taken which leaves
least, whatever the gains are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.quantify.polish import polished
from sher3_effects.operators import held_lag
from sher3_effects.view import StatedLaw
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.axes.view import AxisView
from sher3_chain.chain.evidence import in_blocks
from sher3_chain.constants import INTEGRAL, constants
from sher3_chain.floors.innovation import UNIFORM, foresight, innovation
from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import AxisSignals, signals_of
from sher3_chain.thresholds import LAW_ROUNDED

STAGE = "controller"
"""Stage of the law."""
LAST, TWO, CENTRAL = 0.0, -1.0, -2.0
"""Ways to take a speed from an encoder: over the last period, over the last two, about the sample; above zero it is
that over the last period through a low-pass of first order, of so many periods."""
LAGS = (0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0)
"""Such low-passes that are tried, in periods."""
PLAIN = 0.3
"""Share of the noise of a plain way that a low-pass must leave at most: it has a number that is fitted, and smooths."""
ALIKE = 1.2
"""Noise over the least up to which two ways are alike: a median over thousands of samples is known to some per cent."""
NOTHING_LEFT = 1.0
"""Power over the floor up to which a plain way leaves nothing that another could explain: no other is tried."""
FINER = 9
"""Halvings of the step between two of them."""
SHIFTS = (0, 1, 2, 3, 4, 6, 8, 12, 16, 24)
"""Samples by which a command may answer an earlier reading: within one period nobody states it, more is a delay."""


class Way(NamedTuple):
    """How a controller reads its encoder: the way it takes a speed, and by how many samples it is behind."""

    speed: float
    shift: int

    @property
    def words(self) -> str:
        """How the speed is taken, in words."""
        known = {LAST: "over one period", TWO: "over two periods", CENTRAL: "about the sample"}
        return known.get(self.speed, f"through a low-pass of {self.speed:.2g} periods")


class LawView(AxisView):
    """A run of one axis with the law that its command was stated to follow.

    Attributes:
        stated: the law on what was recorded.
        way: in which it is read.
    """

    def __init__(self, run: AxisSignals, axis: Axis, way: Way) -> None:
        super().__init__(run, axis, 0.0)
        self.stated = stated_law(run, axis, way)
        self.way = way


@dataclass(frozen=True, kw_only=True)
class LawEvidence(AxisEvidence):
    """The engine's evidence for the command of one axis."""


def law_of_axis(runs: Sequence[AxesRun], axis: Axis) -> LawEvidence | None:
    """Return the evidence for the command of an axis; None where no law is stated or nothing was recorded."""
    if not compared(axis) or not all({"reference", "command"} <= run.signals[axis.name].keys() for run in runs):
        return None
    signals = [signals_of(run, axis, run.name) for run in runs]
    way = best_way(signals, axis)
    turned = backwards(signals, axis, way)
    if turned:
        signals = [replace(s, command=-s.command) for s in signals if s.command is not None]
    views = [LawView(s, axis, way) for s in signals]
    channel = Channel(STAGE, axis.name)
    found = [{channel: residual_of(view)} for view in views]
    floors = [{channel: floor_of(view, x[channel])} for view, x in zip(views, found, strict=True)]
    data = in_blocks(views, found, floors)
    return LawEvidence(
        excitations=[view.excitation for view in data.views],
        data=data,
        nuisance=constants(data, INTEGRAL, [channel]) if axis.command_law.integral_gain else (),
        units={channel: unit_of_command(axis)},
        places={"axis": (axis.name,)},
        rotary=frozenset({axis.name} if axis.motion == "rotary" else ()),
        axis=axis,
        runs=list(runs),
        records=views,
        mass=0.0,
        notes=notes_of(axis, way, turned),
    )


def notes_of(axis: Axis, way: Way, turned: bool) -> list[str]:
    """Return how a command was read."""
    notes = [f"{axis.name}: the speed in its law is taken {way.words}"] if axis.command_law.velocity_gain else []
    sign = f"{axis.name}: the command has the opposite sign of the law that was stated; it was turned"
    return [*notes, sign] if turned else notes


def compared(axis: Axis) -> bool:
    """Return whether the description states a law of a command that was recorded."""
    law, signals = axis.command_law, axis.signals
    known = law.kind == "force" and law.position_gain is not None
    return known and signals.command is not None and signals.reference is not None


def best_way(signals: Sequence[AxisSignals], axis: Axis) -> Way:
    """Return the way to read the encoder: the one that leaves least of the steps, and of those alike of the command.

    A plain way that leaves hardly anything of the command as stated, for a reference that may be late, goes before
    it: a controller that knows its speed from elsewhere brings no counts, and the way with the fewest of them is
    then only the smoothest.
    """

    @lru_cache(maxsize=1)  # all shifts of one speed are tried in turn
    def read(speed: float) -> list[StatedLaw]:
        return [stated_law(s, axis, Way(speed, 0)) for s in signals]

    @cache
    def left(way: Way) -> Array:
        laws = read(way.speed)
        return np.sum([left_by(s, behind(x.parts, way.shift)) for s, x in zip(signals, laws, strict=True)], axis=0)

    def noise(way: Way) -> float:
        return float(left(way)[1])

    def least(ways: Sequence[Way]) -> Way:
        quietest = min(noise(way) for way in ways)
        return min((way for way in ways if noise(way) <= ALIKE * quietest), key=lambda way: float(left(way)[0]))

    if not axis.command_law.velocity_gain:
        return _within(least([Way(LAST, shift) for shift in SHIFTS]))
    found = {way: excess(signals, axis, way) for way in (Way(speed, 0) for speed in (LAST, TWO, CENTRAL))}
    plainest = _least_of(found)
    if found[plainest].late <= NOTHING_LEFT:
        return plainest
    plain = least([Way(speed, shift) for speed in (LAST, TWO, CENTRAL) for shift in SHIFTS])
    best = least([Way(speed, shift) for speed in LAGS for shift in SHIFTS])
    step = LAGS[1] / LAGS[0]
    for _ in range(FINER):
        step = float(np.sqrt(step))
        best = least([Way(best.speed * f, shift) for f in (1.0, step, 1.0 / step) for shift in SHIFTS])
    quiet = _within(best if noise(best) < PLAIN * noise(plain) else plain)
    found[quiet] = excess(signals, axis, quiet)
    stated = _least_of(found)
    better = any(a < PLAIN * b for a, b in zip(found[stated], found[quiet], strict=True))
    return stated if better else quiet


def _least_of(found: Mapping[Way, Excess]) -> Way:
    """Return the way that leaves least of a law as stated, of those that leave alike with gains of their own."""
    freest = min(x.freed for x in found.values())
    return min((way for way, x in found.items() if x.freed <= ALIKE * freest), key=lambda way: found[way].late)


def backwards(signals: Sequence[AxisSignals], axis: Axis, way: Way) -> bool:
    """Return whether the commands go against their law over the whole records, an integral beside it left free.

    A sign is a matter of the fit: at the rate of the samples the counts of an encoder, which come back at the next
    sample, outweigh what a law answers to them a period late.
    """
    shares = []
    for run in signals:
        if run.command is not None:
            law = stated_law(run, axis, way)
            shares.append(_solved(np.column_stack([law.command, *_slow(law.error)]), run.command[:, 0])[0])
    return sum(shares) < 0.0


def _slow(error: Array) -> tuple[Array, Array]:
    """Return what a controller may add slowly: a constant, and an integral of its error, (n,) each."""
    return np.ones_like(error), np.cumsum(error)


def _solved(x: Array, y: Array) -> Array:
    """Return the coefficients of y (n,) in columns (n, p), which are brought to one size first."""
    size = np.linalg.norm(x, axis=0)
    x = x / np.where(size > 0.0, size, 1.0)  # of one size, the normal equations are exact enough
    return np.asarray(np.linalg.lstsq(x.T @ x, x.T @ y, rcond=None)[0])


class Excess(NamedTuple):
    """Power of command less law over its floor, a mean over the records.

    Attributes:
        stated: of the law as it is stated.
        late: of the law as it is stated for a reference that may be late.
        freed: of the law with gains of its own for its parts as well: neither is a matter of the way in which the
            encoder is read.
    """

    stated: float
    late: float
    freed: float


def excess(signals: Sequence[AxisSignals], axis: Axis, way: Way) -> Excess:
    """Return what a way leaves of a command, over the floor."""
    powers = []
    for run in signals:
        view = LawView(run, axis, way)
        left = residual_of(view)
        if left.ok.any():
            late, y = _lateness(run), left.values[left.ok, 0]
            free = (run.to_grid(x)[left.ok] for x in (late, np.column_stack([view.stated.parts, late])))
            rest = [y, *(y - x @ np.linalg.lstsq(x, y, rcond=None)[0] for x in free)]
            powers.append(np.mean((np.array(rest) / floor_of(view, left)) ** 2, axis=1))
    return Excess(*np.mean(powers, axis=0).tolist()) if powers else Excess(0.0, 0.0, 0.0)


def _within(way: Way) -> Way:
    """Return a way within the period that nobody states: what is more is a delay."""
    return way if way.shift <= 1 else way._replace(shift=0)


def left_by(run: AxisSignals, parts: Array) -> Array:
    """Return what the parts (n, 3) of a law, each with a gain of its own, leave of the command and its steps; medians.

    Steps are second differences: the counts of the encoder stand out in them, which the right way brings as they are,
    and what else a controller may do, as a dead zone, is slow beside them. The gains are fitted to the command itself:
    in steps a way that reads the counts a period late is bettered by a gain of nothing.
    """
    assert run.command is not None
    command = run.command[:, 0]
    free = np.abs(command) < np.abs(command).max()
    free = free if free[2:].any() else np.ones_like(free)
    x = np.column_stack([parts, np.ones_like(command)])
    size = np.linalg.norm(x[free], axis=0)
    left = command - x / np.where(size > 0.0, size, 1.0) @ _solved(x[free], command[free])
    return np.array([np.median(np.abs(left[free])), np.median(np.abs(np.diff(left, 2)[free[2:]]))])


def _lateness(run: AxisSignals) -> Array:
    """Return what a delay of the reference changes, but for its size: three terms of its series, (n, 3).

    20 ms of a motion at 5 Hz are a phase of 0.63: the third term is 4 % of the reference, the fourth 0.7 %.
    """
    assert run.reference is not None
    speed = np.gradient(run.reference[:, 0])
    bend = np.gradient(speed)
    return np.column_stack([speed, bend, np.gradient(bend)])


def stated_law(run: AxisSignals, axis: Axis, way: Way) -> StatedLaw:
    """Return the stated law on the readings of a run, read in one of the ways."""
    law, q = axis.command_law, run.motor[:, 0]
    assert run.reference is not None and law.position_gain is not None
    error = run.reference[:, 0] - q
    parts = [law.position_gain * error, -law.velocity_gain * speed_of(q, run.period, way.speed)]
    parts.append(law.integral_gain * np.cumsum(error) * run.period)
    late = behind(np.column_stack([*parts, error]), way.shift)
    return StatedLaw(late[:, 3], late[:, :3], law.limit or np.inf, law.position_gain)


def behind(x: Array, shift: int) -> Array:
    """Return columns (n, k) by so many samples late, the first held before."""
    return np.concatenate([x[:1].repeat(shift, axis=0), x])[: len(x)]


def speed_of(q: Array, period: float, way: float) -> Array:
    """Return the speed of a path (n,) taken in one of the ways."""
    if way == TWO:
        return (q - np.concatenate([q[:1].repeat(2), q[:-2]])) / (2.0 * period)
    if way == CENTRAL:
        return np.asarray(np.gradient(q, period))
    pace = np.diff(q, prepend=q[0])[:, None] / period
    return np.append(held_lag(pace, way, 1.0)[1:, 0], pace[-1, 0]) if way > 0.0 else pace[:, 0]


def residual_of(view: LawView) -> Residual:
    """Return command less law."""
    run = view.run
    assert run.command is not None
    left = run.to_grid(run.command - view.stated.command[:, None])
    return Residual(left, run.inner)


def floor_of(view: LawView, left: Residual) -> Array:
    """Return the floor of a command, (1,): what no one foresees, never below counts, rounded gains and speeds."""
    run, law = view.run, view.described.command_law
    assert run.command is not None and law.position_gain is not None
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, 4 * BLOCKS), 1))
    count = view.described.encoder_resolution / UNIFORM
    shaken = law.position_gain * noise - law.velocity_gain * np.diff(noise, axis=0, prepend=0.0) / run.period
    steps = np.diff(np.unique(run.command))
    rounded = (float(steps.min()) if len(steps) else 0.0) / UNIFORM
    written = LAW_ROUNDED * float(np.sqrt(np.mean(run.command**2)))
    apart = (count * run.filtered(shaken).std(), rounded, law.velocity_gain * unread_speed(view), written)
    return np.maximum(innovation(left) / foresight(run), max(float(np.linalg.norm(apart)), np.finfo(float).tiny))


def unread_speed(view: LawView) -> float:
    """Return what differences about a sample are off from a speed that a controller knows otherwise, rms, m/s or rad/s.

    Differences over h are off by a term in h^2: those over 2 h, less those over h, are three times it (Richardson).
    """
    if view.way.speed != CENTRAL:
        return 0.0
    run, q = view.run, view.run.motor[:, 0]
    wide = np.gradient(q, run.period)
    wide[2:-2] = (q[4:] - q[:-4]) / (4.0 * run.period)
    off = run.to_grid((wide - np.gradient(q, run.period))[:, None])[run.inner] / 3.0
    return float(np.sqrt(np.mean(off**2)))


def unit_of_command(axis: Axis) -> str:
    """Return the unit of the recorded command."""
    column = axis.signals.command
    return (column.unit if column is not None else None) or "1"


def causes_of_law(candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of a command; one alone is polished before a second is looked for, since a law is exact."""
    one = polished(candidates.evidence, attribute(candidates, left_over, say, causes=1))
    return attribute(candidates, left_over, say) if left_over(one.fit) else one


def is_law(evidence: Evidence) -> bool:
    """Return whether a piece of evidence is that for a command."""
    return isinstance(evidence, LawEvidence)
