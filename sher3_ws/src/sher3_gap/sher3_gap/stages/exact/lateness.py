"""What decides between the causes of late commands: a constant, a lattice of whole periods, a continuum, a clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS
from sher3_diagnosis.channel import Array
from sher3_diagnosis.thresholds import (
    ANY_JITTER,
    APART,
    CONTINUUM,
    DROPS_SEEN,
    DROPS_USUAL,
    JITTER_OVER_LATENCY,
    MOSTLY_DROPS,
    RANDOM_SHARE,
    SKEW,
)
from sher3_diagnosis.verdict import Parameter

from sher3_gap.stages.exact.timing import WHOLE, Timing

LEAST_SPREAD = 0.01
"""Least half width of a latency's interval, periods: the resolution of the echo's mean."""
LEAST_JITTER = 0.002
"""Jitter beside drops that is none, periods: what rounding makes of ticks on time."""
TAIL = 5.0
"""Latencies over their rms beyond which no jitter reaches: a half-normal one does so once in two million ticks."""
CLOCKED = 0.8
"""Share of late ticks as late as one some ticks before, always as many, from which lateness is a clock's and no chance.
By that argument: chance has the share of its drops, half at most."""


@dataclass(frozen=True)
class Lateness:
    """The facts of a case's timing that decide between its causes; latencies in periods.

    Attributes:
        timing: as read off the echo.
        period: s.
        constant: share of the error that constant latencies explain.
        per_tick: share that a latency of every tick explains.
        usual: median of the axes' latencies; `held`: of the ticks'.
        odd: axes whose latency differs from the usual one.
        jittery: whether the latencies scatter beyond what rare drops do.
        clocked: whether lateness comes round like clockwork: a drive that samples its demand, and no chance.
    """

    timing: Timing
    period: float
    constant: float
    per_tick: float
    usual: float
    held: float
    odd: tuple[int, ...]
    jittery: bool
    clocked: bool

    @classmethod
    def of(cls, t: Timing, period: float) -> Lateness:
        """Work the facts out."""
        usual = float(np.median(t.latency))
        held = float(np.median(t.samples)) if len(t.samples) else usual
        constant, per_tick = 1.0 - t.constant / t.energy, 1.0 - t.per_tick / t.energy
        typical = usual if t.alone is None else float(t.latency[t.alone])
        scatters = t.scatter > JITTER_OVER_LATENCY * max(typical, 1e-9)
        jittery = scatters and per_tick - constant > RANDOM_SHARE and t.drops < DROPS_USUAL
        odd = tuple(i for i, x in enumerate(t.latency) if t.apart > APART and abs(x - usual) > SKEW)
        if t.alone is not None:
            odd = (t.alone,) if held > SKEW and not jittery else ()
        return cls(t, period, constant, per_tick, usual, held, odd, bool(jittery), t.clockwork > CLOCKED)

    @property
    def random_share(self) -> float:
        """Share of the error that only a latency of every tick explains."""
        return self.per_tick - self.constant

    @property
    def rest(self) -> Array:
        """Latencies (m,), periods, of the ticks that were not held for a period or more."""
        return self.timing.samples[self.timing.samples - self.held <= WHOLE]

    @property
    def site(self) -> str:
        """Where random lateness sits."""
        return "all" if self.timing.alone is None else ACTUATORS[self.timing.alone]

    def seconds(self, periods: float) -> Parameter:
        """Return a latency as a parameter, s; its interval is the scatter of the ticks."""
        spread = max(LEAST_SPREAD, self.timing.scatter)
        low, high = (periods - spread) * self.period, (periods + spread) * self.period
        return Parameter(value=periods * self.period, low=low, high=high, unit="s")


def delayed(late: Lateness) -> bool:
    """Whether all commands are late by the same time."""
    some_in_time = len(late.odd) < len(late.timing.latency)
    return late.held > SKEW and not late.jittery and late.timing.alone is None and some_in_time


def dropping(late: Lateness) -> bool:
    """Whether commands are held for whole periods: drops leave a lattice of latencies, jitter a continuum.

    Most of the ticks that are not on time must stand on the lattice. By number, not by energy: the far tail of a jitter
    looks like holds.
    """
    t = late.timing
    if t.drops <= DROPS_SEEN or late.random_share <= RANDOM_SHARE:
        return False
    deviation = t.samples - late.held
    odd = deviation[np.abs(deviation) > SKEW]
    on_lattice = np.abs(odd - np.rint(odd)) < SKEW
    return len(odd) > 0 and float(np.mean(on_lattice)) > MOSTLY_DROPS


def held_beside_jitter(late: Lateness) -> bool:
    """Whether some commands are held for whole periods and all waver by far less: by jitter and by drops.

    What is held must be late by whole periods but for that little, and no tail of a jitter so small reaches that far.
    """
    rest, held = late.rest, late.timing.samples[late.timing.samples - late.held > WHOLE]
    if late.timing.drops <= DROPS_SEEN or len(rest) == 0 or len(held) == 0:
        return False
    rms = float(np.sqrt(np.mean(rest**2)))
    off = held - np.rint(held - late.held)
    near = np.mean((off > -SKEW) & (off < float(rest.max()) + SKEW))
    return bool(TAIL * rms < WHOLE and _continuous(rest) and rms > LEAST_JITTER and near > MOSTLY_DROPS)


def jittering(late: Lateness) -> bool:
    """Whether every command is late by chance; a latency of every tick would reproduce any lateness, so shares alone
    tell nothing.
    """
    return bool((late.jittery or late.random_share > ANY_JITTER) and _continuous(late.timing.samples))


def _continuous(samples: Array) -> bool:
    """Whether latencies lie anywhere: few are the same."""
    low, high = np.quantile(samples, (0.25, 0.75))
    return bool(high - low > CONTINUUM * np.sqrt(np.mean(samples**2)))
