"""Causes in the exact stages: what the timing of the echo and the host's law say, without a fit to noise."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot

from sher3_gap.exact import EXACT, ROUNDING, controller_error, host_law
from sher3_gap.signals import RunSignals
from sher3_gap.timing import Timing
from sher3_gap.verdict import Cause, Interval, Parameter, Where

UNTOLD = 0.005
"""Share of an exact stage's energy in ticks whose timing cannot be told."""
CLOSED = 0.9
"""Closure an exact stage must reach to be explained."""


@dataclass(frozen=True)
class ExactFinding:
    """What one exact stage says: where, causes, closure of all of them."""

    where: Where
    causes: list[Cause]
    closure: float
    note: str = ""


def _where(stage: str, actuator: str, gap: float, floor: float, regime: str) -> Where:
    return Where(stage=stage, actuator=actuator, gap=gap, floor=floor, unit="m/s", regime=regime, confidence=1.0)


def exact_interval(value: float) -> Interval:
    """Interval of a closure in an exact stage: there is no floor to be unsure of, only rare ticks that are not told."""
    return Interval(value=value, low=value - UNTOLD, high=min(1.0, value + UNTOLD))


def _cause(effect: str, family: str, stage: str, actuator: str, closure: float, **parameters: Parameter) -> Cause:
    value = float(np.clip(closure, 0.0, 1.0))
    return Cause(
        effect=effect,
        family=family,
        stage=stage,
        actuator=actuator,
        parameters=parameters,
        closure=exact_interval(value),
    )


def transport_finding(
    timing: Timing | None, runs: Sequence[RunSignals], robot: Robot, without: Collection[str] = ()
) -> ExactFinding | None:
    """Attribute the echo's error to delay, one late axis, jitter or drops; None when commands arrive on time."""
    samples = sum(run.ticks for run in runs if run.command is not None and run.echo is not None)
    if timing is None or samples == 0 or timing.energy / samples < ROUNDING**2:
        return None
    top = float(np.median([a.limits.velocity for a in robot.actuators]))
    gap = top * float(np.sqrt(timing.energy / (samples * len(robot.actuators))))
    causes, closure = _timing_causes(timing, runs, without)
    late = np.flatnonzero(np.abs(timing.latency - np.median(timing.latency)) > SKEW)
    actuator = ACTUATORS[late[0]] if len(late) == 1 and abs(np.median(timing.latency)) < SKEW else "all"
    if timing.alone is not None:
        actuator = ACTUATORS[timing.alone]
    return ExactFinding(
        _where("transport", actuator, gap, EXACT * top, "whenever the command changes"), causes, closure
    )


SKEW = 0.02
"""Difference of the axes' latencies from which they are not alike, periods."""
APART = 0.05
"""Share of the stage's energy that latencies of their own must explain beyond a common one."""
SMALL = 0.005
"""Share of the stage's energy below which a further timing effect is not named."""


def _timing_causes(t: Timing, runs: Sequence[RunSignals], without: Collection[str]) -> tuple[list[Cause], float]:
    period = runs[0].period
    causes: list[Cause] = []
    closure = 0.0
    constant = 1.0 - t.constant / t.energy
    usual = float(np.median(t.latency))
    apart = (t.shared - t.constant) / t.energy > APART
    odd = [i for i in range(len(t.latency)) if apart and abs(t.latency[i] - usual) > SKEW]
    per_tick = 1.0 - t.per_tick / t.energy
    random_share = per_tick - constant
    typical = usual if t.alone is None else float(t.latency[t.alone])
    site = "all" if t.alone is None else ACTUATORS[t.alone]
    jittery = t.scatter > 0.35 * max(typical, 1e-9) and random_share > SMALL and t.drops < 0.5
    dropped = t.drops > 2e-4 and random_share > SMALL
    held = float(np.median(t.samples)) if len(t.samples) else usual
    if t.alone is not None:
        odd = [t.alone] if held > SKEW and not jittery else []

    def seconds(x: float, spread: float) -> Parameter:
        return Parameter(value=x * period, low=(x - spread) * period, high=(x + spread) * period, unit="s")

    spread = max(0.01, t.scatter)
    if held > SKEW and not jittery and "command_delay" not in without and t.alone is None and len(odd) < len(t.latency):
        closure = constant
        causes.append(_cause("command_delay", "timing", "transport", "all", constant, delay=seconds(held, spread)))
    if odd and "axis_skew" not in without:
        closure = max(closure, constant)
        for i in odd:
            causes.append(
                _cause(
                    "axis_skew",
                    "timing",
                    "transport",
                    ACTUATORS[i],
                    constant,
                    skew=seconds(t.latency[i] - usual, spread),
                )
            )
    if dropped and "dropped_commands" not in without and _drop_share(t) > 0.5:
        closure = per_tick
        n = max(1, len(t.samples))
        error = 2.0 * float(np.sqrt(t.drops * (1.0 - t.drops) / n)) + 0.1 * t.drops
        share = Parameter(value=t.drops, low=max(0.0, t.drops - error), high=t.drops + error, unit="1")
        causes.append(_cause("dropped_commands", "timing", "transport", site, per_tick, probability=share))
    elif jittery and "command_jitter" not in without:
        closure = per_tick
        causes.append(_cause("command_jitter", "timing", "transport", site, per_tick, sigma=_sigma(t, period)))
    elif random_share > 0.1 and "command_jitter" not in without:
        closure = per_tick
        causes.append(_cause("command_jitter", "timing", "transport", site, random_share, sigma=_sigma(t, period)))
    return sorted(causes, key=lambda c: -c.closure.value), closure


def _drop_share(t: Timing) -> float:
    """Share of the random energy that sits in whole-period holds."""
    middle = float(np.median(t.samples))
    deviation = t.samples - middle
    whole = deviation > 0.75
    total = float(np.sum(deviation**2))
    return float(np.sum(deviation[whole] ** 2)) / total if total > 0.0 else 0.0


def _sigma(t: Timing, period: float) -> Parameter:
    """Scale of a jitter that only delays: root mean square of the latencies (half-normal), with its standard deviation
    below.
    """
    rms = float(np.sqrt(np.mean(t.samples**2))) * period
    low = float(np.std(t.samples)) * period
    return Parameter(value=rms, low=0.95 * low, high=1.2 * rms, unit="s")


def controller_finding(runs: Sequence[RunSignals], robot: Robot, without: Collection[str] = ()) -> ExactFinding | None:
    """Attribute a difference from the host law to its gain, per axis; None when the law is re-executed exactly."""
    top = np.array([a.limits.velocity for a in robot.actuators])
    errors = [(run, e) for run in runs if (e := controller_error(run, robot)) is not None]
    if not errors:
        return None
    energy = np.sum([np.sum((e / top) ** 2, axis=0) for _, e in errors], axis=0)
    samples = sum(len(e) for _, e in errors)
    bad = [i for i in range(len(top)) if energy[i] / samples > EXACT**2]
    if not bad:
        return None
    gap = float(np.median(top) * np.sqrt(energy[bad].mean() / samples))
    delta = {i: _gain_error([run for run, _ in errors], robot, i) for i in bad}
    scale = np.zeros(len(top))
    for i, d in delta.items():
        scale[i] = d
    left = np.zeros(len(top))
    for run, _ in errors:
        assert run.command is not None
        error = run.command - host_law(run, robot, robot.position_gain * (1.0 + scale))
        left += np.sum((error[run.command_counts] / top) ** 2, axis=0)
    closure = 1.0 - float(left[bad].sum() / energy[bad].sum())
    actuator = "all" if len(bad) > 1 else ACTUATORS[bad[0]]
    where = _where("controller", actuator, gap, EXACT * float(np.median(top)), "position modes")
    causes: list[Cause] = []
    if closure > CLOSED and "controller_gain" not in without:
        values = np.array(list(delta.values()))
        alike = np.ptp(values) < 1e-3 + 0.02 * abs(float(values.mean()))
        sites = (
            [(actuator, float(values.mean()))]
            if alike or len(bad) == 1
            else [(ACTUATORS[i], d) for i, d in delta.items()]
        )
        for site, value in sites:
            width = 1e-4 + 1e-3 * abs(value)
            parameter = Parameter(value=value, low=value - width, high=value + width, unit="1")
            causes.append(_cause("controller_gain", "scale", "controller", site, closure, relative=parameter))
    return ExactFinding(where, causes, closure if causes else 0.0)


def _gain_error(runs: Sequence[RunSignals], robot: Robot, axis: int) -> float:
    """Relative error of the position gain from ticks that are not clamped."""
    top = robot.actuators[axis].limits.velocity
    slope = bend = 0.0
    for run in runs:
        assert run.command is not None and run.reference is not None and run.load is not None
        assert run.reference_velocity is not None
        pull = robot.position_gain * (run.reference - run.load)[:, axis]
        extra = run.command[:, axis] - run.reference_velocity[:, axis] - pull
        free = (np.abs(run.command[:, axis]) < 0.999 * top) & run.command_counts
        slope += float(pull[free] @ extra[free])
        bend += float(pull[free] @ pull[free])
    return slope / bend if bend > 0.0 else 0.0
