"""The exact stages: transport and controller. Their floor is rounding, so any difference is a gap.

Transport: nominally echo(k) = command(k-1). Where the demand changed inside an interval the echo is the mean, so
echo(k) = (1 - a) command(k-1-n) + a command(k-2-n) for a latency of (n + a) periods: each tick tells its own latency.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_diagnosis.channel import Array

from sher3_gap.signals import RunSignals

EXACT = 1e-9
"""Share of an axis' velocity limit below which a difference is rounding."""


ROUNDING = 1e-7
"""The same for demands that went through the integers of a drive's protocol."""
SPORADIC = 0.005
"""Share of ticks at which the demand of a live robot may be held for once, away from ticks that show a late host; as
many as those where these are more."""
AROUND = 15
"""Ticks before and behind one that shows a late host."""
LATE_SHARE = 0.1
"""Share of ticks at which the host of a live robot may work with an earlier reading."""
OLDEST = 8
"""Age of such a reading, ticks."""
MOSTLY = 0.8
"""Share of the odd ticks that lateness must explain before the rest is put down to it too."""


def transport_error(run: RunSignals) -> Array | None:
    """Echo minus the command of the tick before, (n, axes), zero where the echo tells nothing; None without both
    streams.
    """
    if run.command is None or run.echo is None:
        return None
    return np.where(run.echo_tells[:, None], run.echo - delayed(run.command, 1), 0.0)


def delayed(x: Array, ticks: int) -> Array:
    """Return x (n, k) as it was `ticks` samples before; before its first sample a demand is zero."""
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
    """Recorded velocity command minus the host law of the position modes, (n, axes), zero at ticks that do not count;
    None in other modes.
    """
    if run.command is None or run.reference is None or run.reference_velocity is None or run.load is None:
        return None
    return run.command_counts[:, None] * (run.command - host_law(run, robot, robot.position_gain))


def host_law(run: RunSignals, robot: Robot, gain: float | Array) -> Array:
    """Contract §3: set-point velocity plus gain times error, clamped axis by axis, (n, axes)."""
    assert run.reference is not None and run.reference_velocity is not None and run.load is not None
    top = np.array([a.limits.velocity for a in robot.actuators])
    return np.clip(run.reference_velocity + gain * (run.reference - run.load), -top, top)


def with_lateness(run: RunSignals, robot: Robot) -> RunSignals:
    """Mark the ticks of a live recording at which the computer, not the robot, was late.

    A host that is late computes with the reading of an earlier tick, or loses the tick; around such ticks, and now and
    then elsewhere, a command is late too and the drives hold the demand before. Both can be told to rounding. What
    happens more often than that is a gap.
    """
    stale = held = None
    top = np.array([a.limits.velocity for a in robot.actuators])
    error = controller_error(run, robot)
    if error is not None:
        odd = np.abs(error / top).max(axis=1) > EXACT
        stale = _late(odd, _explained(run, robot, top)) if 0.0 < odd.mean() <= LATE_SHARE else None
    echo = transport_error(run)
    if echo is not None:
        assert run.command is not None and run.echo is not None
        odd = np.abs(echo / top).max(axis=1) > ROUNDING
        shown = ~replace(run, stale=stale).command_counts
        near = np.convolve(shown, np.ones(2 * AROUND + 1), "same") > 0.5
        earlier = [np.abs((run.echo - delayed(run.command, n)) / top).max(axis=1) < ROUNDING for n in (2, 3)]
        rest = odd & ~near
        often = rest.mean() > max(SPORADIC, shown.mean())
        late = np.zeros_like(odd) if often else _late(rest, np.logical_or(*earlier))
        held = (odd & near) | late
        held = held if held.any() else None
    return replace(run, stale=stale, held=held)


def _late(odd: NDArray[np.bool_], explained: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Odd ticks that lateness explains; all of them when it explains nearly all."""
    return odd if (odd & explained).sum() > MOSTLY * odd.sum() else odd & explained


def _explained(run: RunSignals, robot: Robot, top: Array) -> NDArray[np.bool_]:
    """Ticks at which the host law with the load reading of one of the last ticks gives the command."""
    assert run.command is not None and run.load is not None
    found = np.zeros(run.ticks, dtype=bool)
    for age in range(1, OLDEST + 1):
        earlier = replace(run, load=np.vstack([np.repeat(run.load[:1], age, axis=0), run.load[:-age]]))
        error = run.command - host_law(earlier, robot, robot.position_gain)
        found |= np.abs(error / top).max(axis=1) <= EXACT
    return found
