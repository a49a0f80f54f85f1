"""The verdict on a serial arm: joint zeros, then the rest of its geometry, where held-out postures ask for it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import cast

import numpy as np

from sher3_gap.attribute import PARSIMONY, PRICE, complexity
from sher3_gap.diagnose import left_over
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit, Term, fit, make_term
from sher3_gap.localise import Gap, gap_of
from sher3_gap.machines.arm_data import ArmData
from sher3_gap.machines.arm_evidence import TIP, ArmEvidence, JointEffect, gather_arm
from sher3_gap.machines.arm_kinematics import Arm, arm_of
from sher3_gap.machines.description import ArmMachine
from sher3_gap.quantify import closure, parameters, residual_after
from sher3_gap.verdict import Cause, Closure, Residual, Unexplained, Verdict, Where

Say = Callable[[str], None]
LAYERS = (("encoder_offset",), ("link_length_error", "rail_tilt"))
"""Effects in the order they are looked for: what homing alone explains is not the machining's."""


def diagnose_arm(machine: ArmMachine, records: Sequence[ArmData], without: Collection[str], say: Say) -> Verdict:
    """Diagnose the geometry of an arm from measured poses. Raises `MachineError`."""
    arm = arm_of(machine)
    q, poses = np.concatenate([r.joints for r in records]), np.concatenate([r.poses for r in records])
    found = gather_arm(arm, q, poses, machine.noise, machine.noise_rotation)
    evidence = cast(Evidence, found)
    null = fit(found.data, [found.frames])
    notes = [f"{len(q)} postures, every tenth held out in turn; floor: the stated noise of a measured pose"]
    notes.append(_held_out_text("measurement frames only", evidence, null))
    gap = gap_of(evidence, TIP, residual_after(evidence, null, TIP))
    assert gap is not None
    if not gap.significant:
        return Verdict(status="no_gap", notes=notes)
    current = null
    for layer in LAYERS:
        names = [n for n in layer if n not in without]
        say(f"fitting {', '.join(names)}")
        current = _grow(found, arm, names, current, null.total)
        notes.append(_held_out_text(f"with {' and '.join(layer)} ({len(current.terms) - 1} in all)", evidence, current))
    causes = _causes(found, current, arm)
    where = Where(
        stage=TIP.stage,
        actuator=TIP.actuator,
        gap=gap.gap,
        floor=gap.floor,
        unit=_unit(gap, machine),
        regime="everywhere",
        confidence=float(1.0 - np.exp(-gap.power)),
    )
    left = gap_of(evidence, TIP, residual_after(evidence, current, TIP))
    assert left is not None
    unexplained = None
    if not causes or left_over(evidence, {TIP: gap}, current):
        unexplained = Unexplained(stage=TIP.stage, actuator=TIP.actuator, signature=_remainder(evidence, current))
    kappa = closure(evidence, TIP, null, current)
    return Verdict(
        status="outside_library" if unexplained else "attributed",
        where=[where],
        causes=causes,
        closure=Closure(stage=kappa, tip=kappa),
        residual=Residual(gap=left.gap, floor=left.floor, unit=_unit(left, machine)),
        unexplained=unexplained,
        notes=notes,
    )


def _unit(gap: Gap, machine: ArmMachine) -> str:
    """Unit of the worse of position and orientation."""
    return "m" if np.isclose(gap.floor, machine.noise) else "rad"


def _grow(found: ArmEvidence, arm: Arm, kinds: Sequence[str], current: Fit, base: float) -> Fit:
    """Add the error that lowers the held-out loss most while it is worth its price; drop those nobody misses."""
    effects = [JointEffect(k, arm, j) for k in kinds for j in range(len(arm.names))]
    left = [make_term(found.data, e, e.name, {}) for e in effects]
    while left:
        trials = [fit(found.data, [*current.terms, t]) for t in left]
        i = int(np.argmin([t.total + PRICE * complexity(t.terms[-1]) for t in trials]))
        if current.total - trials[i].total < _price(left[i], base, current):
            break
        current = trials[i]
        left.pop(i)
    return _prune(found, current, base)


def _price(term: Term, base: float, current: Fit) -> float:
    return 3.0 * PRICE * complexity(term) + PARSIMONY * (base - current.total)


def _prune(found: ArmEvidence, current: Fit, base: float) -> Fit:
    while len(current.terms) > 2:
        reduced = [fit(found.data, [t for t in current.terms if t is not x]) for x in current.terms[1:]]
        worth = [r.total - current.total for r in reduced]
        i = int(np.argmin(worth))
        if worth[i] > _price(current.terms[1 + i], base, current):
            break
        current = reduced[i]
    return current


def _causes(found: ArmEvidence, current: Fit, arm: Arm) -> list[Cause]:
    evidence, out = cast(Evidence, found), []
    for i, term in enumerate(current.terms):
        if i == 0:
            continue
        without = fit(found.data, [t for t in current.terms if t is not term])
        out.append(
            Cause(
                effect=term.effect.id,
                family=term.effect.family,
                stage=term.effect.stage,
                actuator=term.site,
                parameters=parameters(evidence, current, i),
                closure=closure(evidence, TIP, without, current),
            )
        )
    return sorted(out, key=lambda c: -c.closure.value)


def _lengths(evidence: Evidence, current: Fit) -> np.ndarray:
    return np.concatenate([np.linalg.norm(x[:, :3], axis=1) for x in residual_after(evidence, current, TIP).values()])


def _held_out_text(label: str, evidence: Evidence, current: Fit) -> str:
    e = 1e3 * _lengths(evidence, current)
    seen = 1e3 * np.linalg.norm(_seen(evidence, current)[:, :3], axis=1)
    held = f"position error on held-out postures {e.mean():.2f} mm mean, {e.max():.1f} mm worst"
    return f"{label}: {held} ({seen.mean():.2f} mm on those fitted)"


def _seen(evidence: Evidence, current: Fit) -> np.ndarray:
    """Residual of the postures under the coefficients fitted to all of them, (n, 6)."""
    out = []
    for r, target in enumerate(evidence.data.target):
        x = np.hstack([t.columns[r][TIP] for t in current.terms])
        out.append((target[TIP] - x @ current.coefficients).reshape(-1, 6) * evidence.floors[r][TIP])
    return np.concatenate(out)


def _remainder(evidence: Evidence, current: Fit) -> str:
    e = _lengths(evidence, current)
    worst = float(np.sum(np.sort(e**2)[-max(1, len(e) // 20) :]) / np.sum(e**2))
    return f"{1e3 * e.mean():.2f} mm mean left; the worst 5 % of the postures hold {worst:.0%} of its power"
