"""The machine run again from its own reference: simulated against measured position, without and with causes.

A free axis starts where it was let go. Friction is a budget, as in BAM: what would stop the axis within a step acts, up
to the limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np
from scipy.optimize import minimize

from sher3_gap.channels import Array
from sher3_gap.machines.axis_evidence import AxisEvidence
from sher3_gap.machines.description import Axis
from sher3_gap.machines.intake import AxesRun
from sher3_gap.quantify import interval_of
from sher3_gap.verdict import Cause, Interval

BLOCKS = 8
STEP = 1.0e-3
"""Longest integration step, s."""
FORCES = {"coulomb_friction", "stribeck_friction", "viscous_friction", "gravity_load", "torque_constant"}
"""Causes the replay can take in."""
REFINED = ("force", "static", "extra", "relative")
"""Parameters that are refined on a free motion."""


@dataclass(frozen=True)
class Replay:
    """rms of the simulated position's error without and with the causes, and the closure of its mean square."""

    before: float
    after: float
    closure: Interval
    note: str


@dataclass(frozen=True)
class Law:
    """Constants of the simulated axis: resisting forces beyond the nominal ones."""

    coulomb: float = 0.0
    static: float = 0.0
    stribeck: float = 1.0
    viscous: float = 0.0
    offset: float = 0.0
    relative: float = 0.0
    scale: float = 1.0


def replay_closure(
    runs: Sequence[AxesRun], axis: Axis, evidence: AxisEvidence, causes: Sequence[Cause]
) -> Replay | None:
    """Closure of the position; None where the axis cannot be run again: gains or mass not known, no such cause."""
    law = axis.command_law
    closed = law.kind == "force" and law.position_gain is not None and axis.signals.reference is not None
    if not (closed or law.kind == "none") or evidence.mass <= 0.0 or not {c.effect for c in causes} & FORCES:
        return None
    rows, squares = [], []
    for run, view in zip(runs, evidence.records, strict=True):
        first = view.release if law.kind == "none" else 0
        old, new = (simulate(run, axis, evidence.mass, x, first) for x in (Law(), law_of(causes)))
        measured = run.signals[axis.name]["position"][first:]
        errors = np.column_stack([old - measured, new - measured])
        squares.append((errors**2).mean(axis=0))
        count = axis.encoder_resolution**2 / 12.0
        for part in np.array_split(errors, BLOCKS):
            rows.append([*(np.mean(part**2, axis=0) / count), 1.0])
    before, after = np.sqrt(np.mean(squares, axis=0))
    kind = "closed loop run again from its reference" if closed else "free motion run again from its release"
    unit = "m" if axis.motion == "linear" else "rad"
    text = f"position error {before:.4g} {unit} rms nominal, {after:.4g} with the causes"
    note = f"{axis.name}: {kind}: {text}: {1.0 - after / before:.1%} closed in rms"
    return Replay(float(before), float(after), interval_of(np.array(rows)), note)


@dataclass(frozen=True)
class Refined:
    """Mass and causes after the refinement."""

    mass: float
    causes: list[Cause]


def refine_free(runs: Sequence[AxesRun], axis: Axis, evidence: AxisEvidence, causes: list[Cause]) -> Refined:
    """Refine mass (where unknown) and forces of a free axis on its simulated motion, from the force balance's values.

    Nothing holds a free axis to a reference: its motion carries the constants better than twice differentiated counts
    do. Under a position loop it is the other way round, and nothing is refined.
    """
    names = [(i, n) for i, c in enumerate(causes) if c.effect in FORCES for n in c.parameters if n in REFINED]
    if axis.command_law.kind != "none" or evidence.mass <= 0.0 or not names:
        return Refined(evidence.mass, causes)
    free_mass = axis.mass == "unknown"

    def changed(x: Array) -> tuple[float, list[Cause]]:
        factors = dict(zip(names, np.exp(x[: len(names)]), strict=True))
        mass = evidence.mass * (float(np.exp(x[-1])) if free_mass else 1.0)
        return mass, [_scaled(c, {n: f for (j, n), f in factors.items() if j == i}) for i, c in enumerate(causes)]

    def loss(x: Array) -> float:
        mass, new = changed(x)
        return sum(
            float(np.mean(_error(r, axis, mass, law_of(new), v.release) ** 2))
            for r, v in zip(runs, evidence.records, strict=True)
        )

    start = np.zeros(len(names) + free_mass)
    simplex = np.vstack([start, start + 0.1 * np.eye(len(start))])
    best = minimize(
        loss, start, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": 400, "xatol": 1e-4}
    )
    return Refined(*changed(best.x)) if best.fun < loss(start) else Refined(evidence.mass, causes)


def _error(run: AxesRun, axis: Axis, mass: float, law: Law, first: int) -> Array:
    return simulate(run, axis, mass, law, first) - run.signals[axis.name]["position"][first:]


def _scaled(cause: Cause, factors: dict[str, float]) -> Cause:
    """A cause with parameters times factors; their intervals move along and widen by the change."""
    new = dict(cause.parameters)
    for name, f in factors.items():
        p = new[name]
        change = (f - 1.0) * p.value
        if p.low is None or p.high is None:
            new[name] = p.model_copy(update={"value": p.value + change})
        else:
            half = 0.5 * (p.high - p.low) + abs(change)
            value = p.value + change
            new[name] = p.model_copy(update={"value": value, "low": value - half, "high": value + half})
    return cause.model_copy(update={"parameters": new})


def law_of(causes: Sequence[Cause]) -> Law:
    """Constants of the causes the replay can take in."""
    values = {(c.effect, n): p.value for c in causes for n, p in c.parameters.items()}
    coulomb = values.get(("coulomb_friction", "force"), values.get(("stribeck_friction", "force"), 0.0))
    return Law(
        coulomb=coulomb,
        static=values.get(("stribeck_friction", "static"), coulomb),
        stribeck=values.get(("stribeck_friction", "stribeck_velocity"), 1.0),
        viscous=values.get(("viscous_friction", "extra"), 0.0),
        offset=values.get(("gravity_load", "force"), 0.0),
        relative=values.get(("gravity_load", "relative"), 0.0),
        scale=1.0 + values.get(("torque_constant", "relative"), 0.0),
    )


def simulate(run: AxesRun, axis: Axis, mass: float, law: Law, first: int = 0) -> Array:
    """Position of the simulated axis at every sample from `first` on."""
    signals, command = run.signals[axis.name], axis.command_law
    q = signals["position"][first:]
    closed = command.kind == "force"
    reference = signals["reference"][first:] if closed else np.zeros_like(q)
    gains = (
        (command.gain * (command.position_gain or 0.0), command.gain * command.velocity_gain) if closed else (0.0, 0.0)
    )
    top = command.gain * command.limit if closed and command.limit else np.inf
    start = float((q[min(4, len(q) - 1)] - q[0]) / (4.0 * run.period)) if closed else 0.0
    nominal = (mass, axis.viscous, axis.gravity.constant, axis.gravity.arm, axis.gravity.hanging)
    extra = (law.coulomb, law.static, law.stribeck, law.viscous, law.offset, law.relative, law.scale)
    substeps = max(1, int(np.ceil(run.period / STEP - 1e-9)))
    return np.asarray(_run(reference, float(q[0]), start, run.period, substeps, gains, float(top), nominal, extra))


@numba.njit(cache=True)
def _run(
    reference: Array,
    q: float,
    v: float,
    period: float,
    substeps: int,
    gains: tuple[float, float],
    top: float,
    nominal: tuple[float, float, float, float, float],
    extra: tuple[float, float, float, float, float, float, float],
) -> Array:
    """Semi-implicit Euler; the drive sees the two-sample mean velocity and holds its force over a period."""
    mass, viscous, constant, arm, hanging = nominal
    coulomb, static, stribeck, more, offset, relative, scale = extra
    out = np.empty(len(reference))
    h = period / substeps
    for k in range(len(reference)):
        out[k] = q
        speed = (out[k] - out[k - 2]) / (2.0 * period) if k >= 2 else v
        drive = scale * min(max(gains[0] * (reference[k] - q) - gains[1] * speed, -top), top)
        for _ in range(substeps):
            weight = constant + arm * np.sin(q - hanging)
            push = drive - (1.0 + relative) * weight - offset - (viscous + more) * v
            budget = coulomb + (static - coulomb) * np.exp(-((v / stribeck) ** 2))
            free = v + h * push / mass
            stop = mass * free / h
            v = free - h / mass * min(max(stop, -budget), budget)
            q += h * v
    return out
