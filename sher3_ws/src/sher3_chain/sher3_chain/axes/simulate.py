"""An axis run again: semi-implicit Euler of its nominal model, with the constants of the causes.

Friction is a budget, as in BAM (Duclusaud et al.): what would stop the axis within a step acts, up to the friction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from sher3_common.compiled import compiled
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Cause
from sher3_effects import pages

from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun

STEP = 1.0e-3
"""Longest integration step, s."""
FIRST = 4
"""Periods of the record from which the speed at the start is taken: one count in one period is a large speed."""
SETTLES = 0.5
"""Longest period of a controller over the time in which its damping stops the axis: a slower one would not be stable,
so that a log which is slower than this is slower than its controller.
"""
ROUNDING = 1e-9
"""Steps by which a period may exceed a whole number of them through rounding."""


class Law(NamedTuple):
    """Constants of the simulated axis beyond the nominal ones, SI.

    Attributes:
        coulomb, static: friction in motion and at rest, N or N m.
        stribeck: speed over which the one falls to the other, m/s or rad/s.
        viscous: N/(m/s) or N m/(rad/s).
        offset: constant force, N or N m.
        relative: share by which the weight is larger.
        scale: of the drive's force.
        arm, hanging: largest weight at an arm, N m, and where it hangs down, rad.
    """

    coulomb: float = 0.0
    static: float = 0.0
    stribeck: float = 1.0
    viscous: float = 0.0
    offset: float = 0.0
    relative: float = 0.0
    scale: float = 1.0
    arm: float = 0.0
    hanging: float = 0.0


class Nominal(NamedTuple):
    """Nominal constants of the simulated axis: mass, viscous coefficient and weight, SI."""

    mass: float
    viscous: float
    constant: float
    arm: float
    hanging: float


TAKEN = frozenset({"coulomb", "static", "stribeck", "viscous", "offset", "weight", "drive", "arm", "hanging"})
"""Constants that the simulated axis takes in."""


def simulated() -> dict[str, Mapping[str, str]]:
    """Return the causes that the simulated axis can take in: effect id -> its parameters' constants, see `on_axis`."""
    return {p.id: p.on_axis for p in pages("axis") if p.on_axis and set(p.on_axis.values()) <= TAKEN}


def law_of(causes: Sequence[Cause]) -> Law:
    """Return the constants of the causes that the simulated axis can take in."""
    known, given = simulated(), dict[str, float]()
    for cause in sorted(causes, key=lambda c: c.effect):
        for name, constant in known.get(cause.effect, {}).items():
            if name in cause.parameters:
                given.setdefault(constant, cause.parameters[name].value)
    coulomb = given.get("coulomb", 0.0)
    return Law(
        coulomb=coulomb,
        static=given.get("static", coulomb),
        stribeck=given.get("stribeck", 1.0),
        viscous=given.get("viscous", 0.0),
        offset=given.get("offset", 0.0),
        relative=given.get("weight", 0.0),
        scale=1.0 + given.get("drive", 0.0),
        arm=given.get("arm", 0.0),
        hanging=given.get("hanging", 0.0),
    )


def simulate(run: AxesRun, axis: Axis, mass: float, law: Law, first: int = 0) -> Array:
    """Return the position of the simulated axis at every sample from `first` on, (n - first,), m or rad.

    Args:
        run: gives reference and start; without a control loop the axis starts at rest.
        axis: as described.
        mass: nominal or identified, kg or kg m^2.
        law: what the causes add.
        first: sample of the record at which the simulation starts.
    """
    q = run.signals[axis.name]["position"][first:]
    command = axis.command_law
    closed = command.kind == "force" and command.position_gain is not None
    reference, gains, top, start = np.zeros_like(q), (0.0, 0.0), np.inf, 0.0
    if closed:
        assert command.position_gain is not None
        reference = run.signals[axis.name]["reference"][first:]
        gains = (command.gain * command.position_gain, command.gain * command.velocity_gain)
        top = command.gain * command.limit if command.limit else np.inf
        start = float((q[min(FIRST, len(q) - 1)] - q[0]) / (FIRST * run.period))
    gravity = axis.gravity
    nominal = Nominal(mass, axis.viscous, gravity.constant, gravity.arm, gravity.hanging)
    turns = max(1, int(np.ceil(run.period * gains[1] / (SETTLES * mass) - ROUNDING)))
    period = run.period / turns
    substeps = max(1, int(np.ceil(period / STEP - ROUNDING)))
    asked = np.interp(np.arange(len(q) * turns) / turns, np.arange(len(q)), reference)
    return np.asarray(_run(asked, float(q[0]), start, period, substeps, gains, float(top), nominal, law))[::turns]


@compiled
def _run(
    reference: Array,
    q: float,
    v: float,
    period: float,
    substeps: int,
    gains: tuple[float, float],
    top: float,
    nominal: Nominal,
    law: Law,
) -> Array:
    """Position (n,) at each turn of a controller, which sees the mean velocity of two periods and holds its force."""
    out = np.empty(len(reference))
    h = period / substeps
    for k in range(len(reference)):
        out[k] = q
        speed = (out[k] - out[k - 2]) / (2.0 * period) if k >= 2 else v
        drive = law.scale * min(max(gains[0] * (reference[k] - q) - gains[1] * speed, -top), top)
        for _ in range(substeps):
            weight = nominal.constant + nominal.arm * np.sin(q - nominal.hanging)
            weight += law.arm * np.sin(q - law.hanging) / (1.0 + law.relative)
            push = drive - (1.0 + law.relative) * weight - law.offset - (nominal.viscous + law.viscous) * v
            budget = law.coulomb + (law.static - law.coulomb) * np.exp(-((v / law.stribeck) ** 2))
            free = v + h * push / nominal.mass
            stop = nominal.mass * free / h
            v = free - h / nominal.mass * min(max(stop, -budget), budget)
            q += h * v
    return out
