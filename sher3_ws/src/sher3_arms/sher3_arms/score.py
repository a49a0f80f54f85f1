"""Scores of the arms: what was named, where, and whether it abstained where it should."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from sher3_common.numbers.shares import wilson
from sher3_diagnosis import Verdict

from sher3_arms.truth.cases import Label
from sher3_arms.truth.faults import CABLE, COMPOUND, HEALTHY, KINDS

REFUSED = "refused"
"""Status of a case that ended in an error."""
NAMES: Mapping[str, tuple[str, ...]] = {
    "coulomb": ("coulomb_friction", "presliding_friction"),
    "viscous": ("viscous_friction",),
    "armature": ("rotor_inertia",),
    "gain": ("torque_constant",),
    "payload": ("payload_mass",),
    "gear_loss": ("gear_loss",),
    "spring": ("spring_torque", "cable_torque"),
    CABLE: ("cable_torque",),
    "late_drive": ("sensor_delay", "command_delay"),
    "late_effort": ("sensor_delay",),
    "backlash": ("backlash",),
    "elastic": ("transmission_compliance",),
}
"""Fault -> effects that are right answers: presliding friction contains Coulomb friction, a free law a spring."""


@dataclass(frozen=True)
class Scored:
    """One case.

    Attributes:
        seed, robot, kind, joint: of the truth.
        status, effect, place: of the verdict; its first cause.
        top: whether the first cause is the fault; None where there is none to name.
        in_set: whether the fault is the first cause or one of its rivals; of a compound case both are among the causes.
        placed: whether the first cause sits on the right joint, a payload on its link.
        seconds: of the answer.
        fitted: whether `mujoco.sysid` names fault and place, where it was asked.
    """

    seed: int
    robot: str
    kind: str
    joint: str
    status: str
    effect: str
    place: str
    top: bool | None
    in_set: bool | None
    placed: bool | None
    seconds: float
    fitted: bool | None = None

    def as_dict(self) -> dict[str, object]:
        """Return the case as plain data."""
        return asdict(self)


def scored(label: Label, verdict: Verdict | None, seconds: float) -> Scored:
    """Score one verdict; None where the case was refused, which names nothing."""
    kind = COMPOUND if label.fault.second is not None else label.fault.kind
    status, effect, place = REFUSED, "", ""
    top = in_set = placed = False
    if verdict is not None:
        status = verdict.status
        first = verdict.causes[0] if verdict.causes else None
        effect, place = (first.effect, first.actuator) if first else ("", "")
        where = place or (verdict.where[0].actuator if verdict.where else "")
        sought = _sought(label)
        top = any(effect in names and (place in sites or kind != COMPOUND) for names, sites in sought)
        in_set = all(_is_found(verdict, names, sites, kind) for names, sites in sought)
        placed = any(where in sites for _, sites in sought)
    if kind not in (*KINDS, CABLE, COMPOUND):
        return Scored(label.seed, label.robot, kind, label.joint, status, effect, place, None, None, None, seconds)
    return Scored(label.seed, label.robot, kind, label.joint, status, effect, place, top, in_set, placed, seconds)


def names_the_fault(label: Label, effect: str, place: str) -> bool | None:
    """Return whether an effect at a place is the fault of a single case; None for other cases."""
    if label.fault.second is not None or label.fault.kind not in (*KINDS, CABLE):
        return None
    ((names, sites),) = _sought(label)
    return effect in names and place in sites


def _sought(label: Label) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return the right effects of each fault, and the names of its place."""
    places = [(label.joint, label.link), (label.second,)]
    return [(NAMES.get(part.kind, ()), place) for part, place in zip(label.fault.parts, places, strict=False)]


def _is_found(verdict: Verdict, names: tuple[str, ...], sites: tuple[str, ...], kind: str) -> bool:
    """Return whether a fault is among the causes of a compound case, or the first one or its rival of a single one."""
    causes = verdict.causes if kind == COMPOUND else verdict.causes[:1]
    here = [c for c in causes if kind != COMPOUND or c.actuator in sites]
    return any({c.effect, *c.rivals} & set(names) for c in here)


def shares(cases: Sequence[Scored]) -> dict[str, tuple[float, int]]:
    """Return each score as a share and the number of cases it is over."""
    known = [c for c in cases if c.kind in (*KINDS, CABLE)]
    healthy = [c for c in cases if c.kind == HEALTHY]
    compound = [c for c in cases if c.kind == COMPOUND]
    outside = [c for c in cases if c.kind not in (*KINDS, CABLE, COMPOUND, HEALTHY)]
    columns = {
        "top-1": [bool(c.top) for c in known],
        "in the set": [bool(c.in_set) for c in known],
        "joint right": [bool(c.placed) for c in known],
        "known cases called outside": [c.status == "outside_library" for c in known],
        "compound: first one right": [bool(c.top) for c in compound],
        "compound: both named": [bool(c.in_set) for c in compound],
        "mujoco.sysid: top-1": [c.fitted for c in known if c.fitted is not None],
        "healthy alarms": [c.status != "no_gap" for c in healthy],
        "outside abstained": [c.status in ("outside_library", "under_excited") for c in outside],
    }
    return {name: (sum(x) / len(x) if x else float("nan"), len(x)) for name, x in columns.items()}


def table(cases: Sequence[Scored]) -> str:
    """Return the scores, overall and for each kind of fault, as text."""
    lines = [_line(name, share, n) for name, (share, n) in shares(cases).items() if n]
    worst = max((c.seconds for c in cases), default=0.0)
    lines.append(f"{'slowest answer':<28} {worst:6.1f} s")
    lines.append("")
    for kind in dict.fromkeys(c.kind for c in cases):
        found = [c for c in cases if c.kind == kind]
        named = ", ".join(f"{c.effect or c.status}" for c in found)
        lines.append(f"{kind:<16} {sum(c.top is True for c in found)} of {len(found)}: {named}")
    return "\n".join(lines)


def _line(name: str, share: float, n: int) -> str:
    low, high = wilson(share, n)
    return f"{name:<28} {share:6.2f}  ({low:.2f} .. {high:.2f})  of {n}"
