"""Causes in the transport of commands, read off the timing of the echo: delay, one late axis, drops, jitter."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.thresholds import SKEW
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import computed

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.findings import computed_cause, exact_finding, exact_place
from sher3_gap.stages.exact.lateness import Lateness, delayed, dropping, held_beside_jitter, jittering
from sher3_gap.stages.exact.law import EXACT, ROUNDING
from sher3_gap.stages.exact.timing import Timing


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


def _causes(late: Lateness, without: Collection[str]) -> tuple[list[Cause], float]:
    """Causes of a case's lateness, most closure first, and the closure of all of them."""
    causes, closure = _constant_causes(late, without)
    if not late.clocked:
        found = _random_causes(late)
        causes += [c for c in found if c.effect not in without]
        if found and not any(c.effect in without for c in found):
            closure = late.per_tick
    return sorted(causes, key=lambda c: -c.closure.value), closure


def _constant_causes(late: Lateness, without: Collection[str]) -> tuple[list[Cause], float]:
    """Causes that make every command of an axis late by the same time, and their closure."""
    causes: list[Cause] = []
    closure = 0.0
    if delayed(late) and computed("delay").id not in without:
        closure = late.constant
        causes.append(computed_cause("delay", late.seconds(late.held), "all", late.constant))
    if late.odd and (late.constant > late.random_share or dropping(late)) and computed("skew").id not in without:
        closure = max(closure, late.constant)
        for i in late.odd:
            skew = late.seconds(late.timing.latency[i] - late.usual)
            causes.append(computed_cause("skew", skew, ACTUATORS[i], late.constant))
    return causes, closure


def _random_causes(late: Lateness) -> list[Cause]:
    """Causes that make some ticks late by chance.

    Drops alone are no jitter, even where they are not in the library: a continuum leaves no lattice.
    """
    t = late.timing
    if held_beside_jitter(late):
        squares = float(np.sum(late.rest**2)) / float(np.sum(t.samples**2))
        return [
            computed_cause("probability", _probability(t), late.site, (1.0 - squares) * late.per_tick),
            computed_cause("sigma", _sigma(late, late.rest), late.site, squares * late.per_tick),
        ]
    if dropping(late):
        return [computed_cause("probability", _probability(t), late.site, late.per_tick)]
    if jittering(late):
        share = late.per_tick if late.jittery else late.random_share
        return [computed_cause("sigma", _sigma(late, t.samples), late.site, share)]
    return []


def _probability(t: Timing) -> Parameter:
    """Share of the commands that are dropped; twice its binomial standard error and a tenth for ticks not told."""
    n = max(1, len(t.samples))
    error = 2.0 * float(np.sqrt(t.drops * (1.0 - t.drops) / n)) + 0.1 * t.drops
    return Parameter(value=t.drops, low=max(0.0, t.drops - error), high=t.drops + error, unit="1")


def _sigma(late: Lateness, samples: Array) -> Parameter:
    """Scale of a jitter that only delays: the rms of the latencies (half-normal), their standard deviation below it."""
    rms = float(np.sqrt(np.mean(samples**2))) * late.period
    return Parameter(value=rms, low=0.95 * float(np.std(samples)) * late.period, high=1.2 * rms, unit="s")
