"""The exact stages: transport and controller. Their floor is rounding, so any difference is a gap.

Transport: nominally echo(k) = command(k-1). Where the demand changed inside an interval the echo is the mean, so
echo(k) = (1 - a) command(k-1-n) + a command(k-2-n) for a latency of (n + a) periods: each tick tells its own latency.
"""

from __future__ import annotations

import numpy as np
from sher3_description import Robot

from sher3_gap.channels import Array
from sher3_gap.signals import RunSignals

EXACT = 1e-9
"""Share of an axis' velocity limit below which a difference is rounding."""


def transport_error(run: RunSignals) -> Array | None:
    """Echo minus the command of the tick before, (n, axes), zero where the echo tells nothing; None without both
    streams.
    """
    if run.command is None or run.echo is None:
        return None
    return np.where(run.echo_tells[:, None], run.echo - delayed(run.command, 1), 0.0)


def delayed(x: Array, ticks: int) -> Array:
    """Shift down by `ticks` samples; before its first sample a demand is zero."""
    out = np.zeros_like(x)
    if ticks < len(x):
        out[ticks:] = x[: len(x) - ticks]
    return out


def shifted(command: Array, latency: float) -> Array:
    """Echo of a command held with a constant latency in periods, (n, axes)."""
    whole = int(np.floor(latency))
    part = latency - whole
    return (1.0 - part) * delayed(command, 1 + whole) + part * delayed(command, 2 + whole)


def controller_error(run: RunSignals, robot: Robot) -> Array | None:
    """Recorded velocity command minus the host law of the position modes, (n, axes), zero at lost ticks; None in other
    modes.
    """
    if run.command is None or run.reference is None or run.reference_velocity is None or run.load is None:
        return None
    return without_lost(run, run.command - host_law(run, robot, robot.position_gain))


def without_lost(run: RunSignals, error: Array) -> Array:
    """Set an (n, axes) error to zero at ticks that were not recorded."""
    return error if run.lost is None else np.where(run.lost[:, None], 0.0, error)


def host_law(run: RunSignals, robot: Robot, gain: float | Array) -> Array:
    """Contract §3: set-point velocity plus gain times error, clamped axis by axis, (n, axes)."""
    assert run.reference is not None and run.reference_velocity is not None and run.load is not None
    top = np.array([a.limits.velocity for a in robot.actuators])
    return np.clip(run.reference_velocity + gain * (run.reference - run.load), -top, top)
