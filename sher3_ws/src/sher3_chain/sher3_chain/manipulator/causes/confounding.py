"""What the recorded motion cannot tell apart, computed before anything is fitted.

Every quantity that may be off gives columns of the stacked regressor: the force that a unit of it adds. Scaled to
length one, a combination of columns that nearly cancels is a change of several quantities that nobody can see
(near-null space; Gautier and Khalil, IEEE Trans. Robotics and Automation 6, 1990, for the inertial parameters).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Cause
from sher3_effects import pages

from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.manipulator.library import joint_pages
from sher3_chain.manipulator.view import MotionView
from sher3_chain.thresholds import CONFOUNDED, TAKES_PART

WEIGH = (
    "a known weight does: put one on the last link, or on the axis, record the same motion without and with it, and "
    "state it under `carried`, or tag the runs by `payload` where no mass is stated"
)
FEEL = "the force does: record the motor's current, or a sensor's reading, with the same motion, as `effort`"
"""What tells causes apart that no motion does."""
IN_STEP = (
    "the joints moved in step: what one link does to them others do nearly as well, and no wrong link is told; a "
    "motion of one joint after the other, or of each at a rate of its own, tells it"
)
GAIN, WEIGHT, PAYLOAD = "drive gain", "weight", "payload"
"""Quantities that multiply one force, see `Effect.scales`."""


def same_force() -> list[str]:
    """Return the ids of the effects by which these quantities are off, in their order."""
    return [e.id for quantity in (GAIN, WEIGHT, PAYLOAD) for e in joint_pages() if e.scales == quantity]


def confounded(columns: Mapping[str, Array]) -> list[frozenset[str]]:
    """Return the sets of quantities of which only a combination can be told.

    Args:
        columns: quantity -> (N, p) what it adds; columns of zeros are not excited and are left out.
    """
    names = [name for name, x in columns.items() for _ in range(x.shape[1])]
    stacked = np.hstack(list(columns.values()))
    length = np.linalg.norm(stacked, axis=0)
    alive = length > 1e-9 * max(float(length.max(initial=0.0)), 1e-300)
    if alive.sum() < 2:
        return []
    values, vectors = np.linalg.svd(stacked[:, alive] / length[alive], full_matrices=False)[1:]
    kept = [n for n, a in zip(names, alive, strict=True) if a]
    out = []
    for value, vector in zip(values, vectors, strict=True):
        if value < CONFOUNDED:
            taking = {n for n, x in zip(kept, vector, strict=True) if abs(x) > TAKES_PART}
            if len(taking) > 1:
                out.append(frozenset(taking))
    return joined(out)


def joined(groups: Sequence[frozenset[str]]) -> list[frozenset[str]]:
    """Return the groups; groups that share a quantity are joined."""
    out: list[frozenset[str]] = []
    for group in groups:
        meeting = [g for g in out if g & group]
        out = [g for g in out if g not in meeting] + [group.union(*meeting)]
    return out


def confounded_in(evidence: ArmMotionEvidence, joint: str) -> list[frozenset[str]]:
    """Return what the force balance of one joint cannot tell apart."""
    parts = [_columns(evidence, view, joint) for view in evidence.records]
    return confounded({name: np.concatenate([p[name] for p in parts]) for name in parts[0]})


def _columns(evidence: ArmMotionEvidence, view: MotionView, joint: str) -> dict[str, Array]:
    row, ok = view.row(joint), view.in_motion(view.row(joint))
    carried = view.payload(evidence.places["link"][-1], (0.0, 0.0, 0.0)).get(joint, np.zeros((len(ok), 1)))
    out = {
        GAIN: view.rigid[ok, row][:, None],
        WEIGHT: view.path.gravity[ok, row][:, None] / (view.shares[row] or 1.0),
        PAYLOAD: carried[ok] / (view.shares[row] or 1.0),
        "constant force": np.ones((int(ok.sum()), 1)),
        "rotor inertia": view.acceleration[ok, row][:, None],
        "viscous friction": view.velocity[ok, row][:, None],
        "Coulomb friction": np.sign(view.velocity[ok, row])[:, None],
    }
    return out


def in_step(evidence: ArmMotionEvidence) -> bool:
    """Return whether the judged joints moved as one: what a link does to one of them is seen in every other as well.

    Of their places, each of length one, hardly anything is left beside one motion that all share.
    """
    rows = [evidence.records[0].row(joint) for joint in evidence.judged]
    places = np.concatenate([view.position[:, rows] for view in evidence.records])
    places = places - places.mean(axis=0)
    length = np.linalg.norm(places, axis=0)
    size = np.linalg.svd(places[:, length > 0.0] / length[length > 0.0], compute_uv=False)
    return len(size) > 1 and bool(size[1] < CONFOUNDED * size[0])


def confounding_notes(evidence: ArmMotionEvidence) -> list[str]:
    """Return in words what cannot be told apart, joint by joint; the same of several joints in one sentence."""
    found: dict[frozenset[str], list[str]] = {}
    for joint in evidence.judged:
        for group in confounded_in(evidence, joint):
            found.setdefault(group, []).append(joint)
    step = [IN_STEP] if in_step(evidence) else []
    return step + [
        f"{', '.join(joints)}: the recorded motion cannot tell {_listed(sorted(g))} apart"
        for g, joints in found.items()
    ]


def alike_in_motion(cause: Cause) -> list[tuple[list[str], str]]:
    """Return the effects, of a cause and its rivals, that no motion tells apart, and what does; [] of none.

    The drive's gain, weight and payload multiply one force; a weight that somebody put on a scale adds another one.
    """
    same, rivals = set(same_force()), cause.rivals
    unfelt = {x for kind in ("servo", "joint") for e in pages(kind) if e.id == cause.effect for x in e.indistinct}
    heavy = [e for e in (cause.effect, *rivals) if e in same]
    return [x for x in ((heavy, WEIGH), ([cause.effect, *(e for e in rivals if e in unfelt)], FEEL)) if len(x[0]) > 1]


def beyond_motion(causes: Iterable[Cause]) -> list[str]:
    """Return in words what would tell causes apart that no motion tells apart, once for all places."""
    found: dict[tuple[str, str], list[str]] = {}
    for cause in causes:
        for effects, remedy in alike_in_motion(cause):
            found.setdefault((_listed([e.replace("_", " ") for e in effects]), remedy), []).append(cause.actuator)
    return [
        f"no motion tells {names} on {', '.join(dict.fromkeys(sites))} apart, {remedy}"
        for (names, remedy), sites in found.items()
    ]


def _listed(words: Sequence[str]) -> str:
    return f"{', '.join(words[:-1])} and {words[-1]}"
