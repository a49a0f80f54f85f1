"""Causes in the transport of commands, read off the timing of the echo: delay, one late axis, drops, jitter."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.finding import ExactFinding
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
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects.timing.axis_skew import AxisSkew
from sher3_effects.timing.command_delay import CommandDelay
from sher3_effects.timing.command_jitter import CommandJitter
from sher3_effects.timing.dropped_commands import DroppedCommands

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.findings import exact_cause, exact_finding, exact_place
from sher3_gap.stages.exact.law import EXACT, ROUNDING
from sher3_gap.stages.exact.timing import Timing

LEAST_SPREAD = 0.01
"""Least half width of a latency's interval, periods: the resolution of the echo's mean."""


def transport_finding(
    timing: Timing | None, runs: Sequence[RunSignals], robot: Robot, without: Collection[str] = ()
) -> ExactFinding | None:
    """Attribute the echo's error to delay, one late axis, drops or jitter; None when commands arrive on time."""
    samples = sum(run.ticks for run in runs if run.command is not None and run.echo is not None)
    if timing is None or samples == 0 or timing.energy / samples < ROUNDING**2:
        return None
    top = float(np.median([a.limits.velocity for a in robot.actuators]))
    gap = top * float(np.sqrt(timing.energy / (samples * len(robot.actuators))))
    causes, closure = _causes(Lateness.of(timing, runs[0].period), without)
    where = exact_place("transport", _actuator(timing), gap, EXACT * top, "whenever the command changes")
    return exact_finding(where, causes, closure)


def _actuator(timing: Timing) -> str:
    """The axis that alone is late, else all of them."""
    if timing.alone is not None:
        return ACTUATORS[timing.alone]
    usual = float(np.median(timing.latency))
    late = np.flatnonzero(np.abs(timing.latency - usual) > SKEW)
    return ACTUATORS[late[0]] if len(late) == 1 and abs(usual) < SKEW else "all"


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
    """

    timing: Timing
    period: float
    constant: float
    per_tick: float
    usual: float
    held: float
    odd: tuple[int, ...]
    jittery: bool

    @classmethod
    def of(cls, t: Timing, period: float) -> Lateness:
        """Work the facts out."""
        usual = float(np.median(t.latency))
        held = float(np.median(t.samples)) if len(t.samples) else usual
        constant, per_tick = 1.0 - t.constant / t.energy, 1.0 - t.per_tick / t.energy
        typical = usual if t.alone is None else float(t.latency[t.alone])
        scatters = t.scatter > JITTER_OVER_LATENCY * max(typical, 1e-9)
        jittery = scatters and per_tick - constant > RANDOM_SHARE and t.drops < DROPS_USUAL
        apart = (t.shared - t.constant) / t.energy > APART
        odd = tuple(i for i, x in enumerate(t.latency) if apart and abs(x - usual) > SKEW)
        if t.alone is not None:
            odd = (t.alone,) if held > SKEW and not jittery else ()
        return cls(t, period, constant, per_tick, usual, held, odd, bool(jittery))

    @property
    def random_share(self) -> float:
        """Share of the error that only a latency of every tick explains."""
        return self.per_tick - self.constant

    @property
    def site(self) -> str:
        """Where random lateness sits."""
        return "all" if self.timing.alone is None else ACTUATORS[self.timing.alone]

    def seconds(self, periods: float) -> Parameter:
        """Return a latency as a parameter, s; its interval is the scatter of the ticks."""
        spread = max(LEAST_SPREAD, self.timing.scatter)
        low, high = (periods - spread) * self.period, (periods + spread) * self.period
        return Parameter(value=periods * self.period, low=low, high=high, unit="s")


def _causes(late: Lateness, without: Collection[str]) -> tuple[list[Cause], float]:
    """Causes of a case's lateness, most closure first, and the closure of all of them."""
    causes: list[Cause] = []
    closure = 0.0
    if _delayed(late) and CommandDelay.id not in without:
        closure = late.constant
        causes.append(exact_cause(CommandDelay.id, "all", late.constant, delay=late.seconds(late.held)))
    if late.odd and late.constant > late.random_share and AxisSkew.id not in without:
        closure = max(closure, late.constant)
        for i in late.odd:
            skew = late.seconds(late.timing.latency[i] - late.usual)
            causes.append(exact_cause(AxisSkew.id, ACTUATORS[i], late.constant, skew=skew))
    if _dropping(late):  # and no jitter, even where drops are not in the library: a continuum leaves no lattice
        if DroppedCommands.id not in without:
            closure, lost = late.per_tick, _probability(late.timing)
            causes.append(exact_cause(DroppedCommands.id, late.site, late.per_tick, probability=lost))
    elif CommandJitter.id not in without and _jittering(late):
        closure = late.per_tick
        share = late.per_tick if late.jittery else late.random_share
        causes.append(exact_cause(CommandJitter.id, late.site, share, sigma=_sigma(late)))
    return sorted(causes, key=lambda c: -c.closure.value), closure


def _delayed(late: Lateness) -> bool:
    """Whether all commands are late by the same time."""
    some_in_time = len(late.odd) < len(late.timing.latency)
    return late.held > SKEW and not late.jittery and late.timing.alone is None and some_in_time


def _dropping(late: Lateness) -> bool:
    """Whether commands are held for whole periods: drops leave a lattice of latencies, jitter a continuum.

    Most of the ticks that are not on time must stand on the lattice. By number, not by energy: the far tail of a jitter
    looks like holds.
    """
    t = late.timing
    if t.drops <= DROPS_SEEN or late.random_share <= RANDOM_SHARE:
        return False
    deviation = t.samples - float(np.median(t.samples))
    odd = deviation[np.abs(deviation) > SKEW]
    on_lattice = np.abs(odd - np.rint(odd)) < SKEW
    return len(odd) > 0 and float(np.mean(on_lattice)) > MOSTLY_DROPS


def _jittering(late: Lateness) -> bool:
    """Whether every command is late by chance; a latency of every tick would reproduce any lateness, so shares alone
    tell nothing.
    """
    low, high, rms = *np.quantile(late.timing.samples, (0.25, 0.75)), np.sqrt(np.mean(late.timing.samples**2))
    return bool((late.jittery or late.random_share > ANY_JITTER) and high - low > CONTINUUM * rms)


def _probability(t: Timing) -> Parameter:
    """Share of the commands that are dropped; twice its binomial standard error and a tenth for ticks not told."""
    n = max(1, len(t.samples))
    error = 2.0 * float(np.sqrt(t.drops * (1.0 - t.drops) / n)) + 0.1 * t.drops
    return Parameter(value=t.drops, low=max(0.0, t.drops - error), high=t.drops + error, unit="1")


def _sigma(late: Lateness) -> Parameter:
    """Scale of a jitter that only delays: the rms of the latencies (half-normal), their standard deviation below it."""
    rms = float(np.sqrt(np.mean(late.timing.samples**2))) * late.period
    low = float(np.std(late.timing.samples)) * late.period
    return Parameter(value=rms, low=0.95 * low, high=1.2 * rms, unit="s")
