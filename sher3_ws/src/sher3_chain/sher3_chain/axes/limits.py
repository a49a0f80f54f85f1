"""A drive at its limit: the command lies flat at its largest value while the axis does not get where it is sent.

It is read off the command itself, as timing is read off the SHER's echo: a level at which a record stays is no matter
of fitting. What the axis would need is the commanded law, where its gains are known; otherwise it is what holds the
nominal weight on the way to the goal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.localise.floors import UNIFORM
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.thresholds import MIN_RUNS
from sher3_diagnosis.verdict import Cause, Parameter, Residual, Where
from sher3_effects import computed
from sher3_machines.intake.mending.readings import longest_run
from sher3_machines.thresholds import BLOCKS

from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import signals_of
from sher3_chain.thresholds import FLAT, LIMIT_UNCERTAINTY, LONGEST, PINNED

LIMIT = "limit"
"""Parameter that this finding gives, see `Page.computed`."""
FLOOR_DEVIATIONS = 2.0
"""Floors in the half width of a limit's interval: about 95 % of a normal spread."""
ON_THE_WAY = 50
"""Positions between the axis and its goal at which the weight is looked at."""


@dataclass(frozen=True)
class Pinned:
    """One record with its drive at the limit, N or N m.

    Attributes:
        level: the limit, read off the force given there.
        gap: rms of what the axis needs beyond what it is given.
        floor: rms of the given force about the command.
        share: of the record at the limit.
        losses: (blocks, 3) gap before and after, and the floor, in squares of the floor.
    """

    level: float
    gap: float
    floor: float
    share: float
    losses: Array


def limit_finding(runs: Sequence[AxesRun], axis: Axis) -> ExactFinding | None:
    """Find a limit that keeps an axis from its goal; None when there is none, or no command was recorded."""
    if axis.signals.command is None or axis.command_law.kind != "force":
        return None
    found = [pinned for run in runs if (pinned := pinned_in(run, axis)) is not None]
    return _finding(axis, found) if found else None


def pinned_in(run: AxesRun, axis: Axis) -> Pinned | None:
    """Look for a limit in one record; None where its command does not stay at its largest value."""
    signals = run.signals[axis.name]
    command = axis.command_law.gain * signals["command"]
    level = float(np.abs(command).max())
    need = needed_force(run, axis)
    flat = np.abs(command) >= (1.0 - FLAT) * level
    pinned = flat & (need * np.sign(command) > (1.0 + FLAT) * level)
    if level == 0.0 or pinned.mean() < PINNED or longest_run(pinned) < LONGEST:
        return None
    given = signals.get("effort", command)
    floor = max(float(np.std(given[flat] - command[flat])), axis.effort_resolution / UNIFORM, FLAT * level)
    losses = []
    for part in np.array_split(np.flatnonzero(pinned), BLOCKS):
        before, after = need[part] - given[part], command[part] - given[part]
        losses.append([float(np.mean((before / floor) ** 2)), float(np.mean((after / floor) ** 2)), 1.0])
    return Pinned(
        level=float(np.median(np.abs(given[pinned]))),
        gap=float(np.sqrt(np.mean((need - given)[pinned] ** 2))),
        floor=floor,
        share=float(pinned.mean()),
        losses=np.array(losses),
    )


def _finding(axis: Axis, found: Sequence[Pinned]) -> ExactFinding:
    unit = axis.unit_of_force
    losses = np.concatenate([x.losses for x in found])
    level = float(np.median([x.level for x in found]))
    gap, floor, share = (float(np.mean([getattr(x, n) for x in found])) for n in ("gap", "floor", "share"))
    half = max(FLOOR_DEVIATIONS * floor, LIMIT_UNCERTAINTY * level)
    low, high = (level - half, level + half) if len(losses) >= MIN_RUNS else (None, None)
    closure = interval_of(losses)
    page = computed(LIMIT)
    cause = Cause(
        effect=page.id,
        family=page.family,
        stage=page.stage,
        actuator=axis.name,
        parameters={LIMIT: Parameter(value=level, low=low, high=high, unit=unit)},
        closure=closure,
    )
    where = Where(
        stage=page.stage,
        actuator=axis.name,
        gap=gap,
        floor=floor,
        unit=unit,
        regime=f"{share:.0%} of the time at the limit",
        confidence=float(1.0 - np.exp(-gap / floor)),
    )
    left = floor * float(np.sqrt(losses[:, 1].mean()))
    return ExactFinding(where, [cause], closure, Residual(gap=left, floor=floor, unit=unit))


def needed_force(run: AxesRun, axis: Axis) -> Array:
    """Return the force that the nominal machine asks for at each sample without a limit, (n,), N or N m."""
    signals, law, gravity = run.signals[axis.name], axis.command_law, axis.gravity
    q = signals["position"]
    goal = signals.get("reference") if law.goal is None else np.full_like(q, law.goal)
    if goal is None:
        return np.zeros_like(q)
    if law.position_gain is not None:
        velocity = signals_of(run, axis, run.name).velocity[:, 0]
        return np.asarray(law.gain * (law.position_gain * (goal - q) - law.velocity_gain * velocity))
    way = np.linspace(0.0, 1.0, ON_THE_WAY)[:, None] * (goal - q) + q
    weight = gravity.constant + gravity.arm * np.sin(way - gravity.hanging)
    return np.asarray(np.take_along_axis(weight, np.abs(weight).argmax(axis=0)[None], 0)[0])
