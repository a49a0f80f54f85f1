"""Causes in the host's control law: another position gain, found by computing the law again."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.thresholds import REPRODUCED, SAME_GAIN
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import computed

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.findings import computed_cause, exact_finding, exact_place
from sher3_gap.stages.exact.law import EXACT, controller_error, host_law

NOT_CLAMPED = 0.999
"""Share of the velocity limit below which a command was not clamped by it."""


def controller_finding(runs: Sequence[RunSignals], robot: Robot, without: Collection[str] = ()) -> ExactFinding | None:
    """Attribute a difference from the host law to its gain, per axis; None when the law is re-executed exactly."""
    errors = {i: e for i, run in enumerate(runs) if (e := controller_error(run, robot)) is not None}
    if not errors:
        return None
    judged = [runs[i] for i in errors]
    top = np.array([a.limits.velocity for a in robot.actuators])
    energy = np.sum([np.sum((e / top) ** 2, axis=0) for e in errors.values()], axis=0)
    samples = sum(len(e) for e in errors.values())
    bad = [i for i in range(len(top)) if energy[i] / samples > EXACT**2]
    if not bad:
        return None
    gains = {i: gain_error(judged, robot, i) for i in bad}
    closure = 1.0 - float(_residual_energy(judged, robot, gains)[bad].sum() / energy[bad].sum())
    causes = _causes(gains, closure) if closure > REPRODUCED and computed("relative").id not in without else []
    gap = float(np.median(top) * np.sqrt(energy[bad].mean() / samples))
    where = exact_place("controller", _site(bad), gap, EXACT * float(np.median(top)), "position modes")
    return exact_finding(where, causes, closure if causes else 0.0)


def _site(axes: Sequence[int]) -> str:
    return "all" if len(axes) > 1 else ACTUATORS[axes[0]]


def _residual_energy(runs: Sequence[RunSignals], robot: Robot, gains: Mapping[int, float]) -> Array:
    """Energy that the law with other gains leaves, (axes,), over the velocity limits."""
    top = np.array([a.limits.velocity for a in robot.actuators])
    scale = np.array([1.0 + gains.get(i, 0.0) for i in range(len(top))])
    left = np.zeros(len(top))
    for run in runs:
        assert run.command is not None
        error = run.command - host_law(run, robot, robot.position_gain * scale)
        left += np.sum((error[run.command_counts] / top) ** 2, axis=0)
    return left


def _causes(gains: Mapping[int, float], closure: float) -> list[Cause]:
    """One cause where all axes have the same gain error, else one for each."""
    values = np.array(list(gains.values()))
    mean = float(values.mean())
    alike = np.ptp(values) < SAME_GAIN[0] + SAME_GAIN[1] * abs(mean)
    sites = [(_site(list(gains)), mean)] if alike or len(gains) == 1 else [(ACTUATORS[i], d) for i, d in gains.items()]
    return [computed_cause("relative", _relative(value), site, closure) for site, value in sites]


def _relative(value: float) -> Parameter:
    """A gain error; its interval is the rounding of the recorded commands."""
    width = 1e-4 + 1e-3 * abs(value)
    return Parameter(value=value, low=value - width, high=value + width, unit="1")


def gain_error(runs: Sequence[RunSignals], robot: Robot, axis: int) -> float:
    """Return the relative error of the position gain of one axis, from ticks whose command is not clamped."""
    top = robot.actuators[axis].limits.velocity
    slope = bend = 0.0
    for run in runs:
        assert run.command is not None and run.reference is not None and run.load is not None
        assert run.reference_velocity is not None
        pull = robot.position_gain * (run.reference - run.load)[:, axis]
        extra = run.command[:, axis] - run.reference_velocity[:, axis] - pull
        free = (np.abs(run.command[:, axis]) < NOT_CLAMPED * top) & run.command_counts
        slope += float(pull[free] @ extra[free])
        bend += float(pull[free] @ pull[free])
    return slope / bend if bend > 0.0 else 0.0
