"""Joints of an MJCF model that an equality makes follow another joint by a line (`<equality><joint polycoef>`)."""

from __future__ import annotations

from typing import Any, NamedTuple

from sher3_chain.manipulator.mjcf.passive import at_joint, is_passive
from sher3_chain.manipulator.rigid.tree import Gear

OF_JOINTS = 2
"""MuJoCo's number of an equality of joints (mjtEq)."""


class Coupling(NamedTuple):
    """Two joints by number, the second -1 where there is one alone; `gear` of the `follower`, None where it is none."""

    joints: tuple[int, int]
    follower: int = -1
    gear: Gear | None = None


def gears_of(source: Any) -> dict[int, Gear]:
    """Return follower by number -> its gear."""
    return {x.follower: x.gear for x in couplings(source) if x.gear is not None}


def coupled(source: Any, joint: int) -> bool:
    """Return whether the force of a joint is not told by its own drive: it follows another, or no gear couples it."""
    return any(joint in x.joints and (x.gear is None or x.follower == joint) for x in couplings(source))


def couplings(source: Any) -> list[Coupling]:
    """Return the active equalities of joints of an `MjModel`."""
    known = range(source.neq)
    return [_coupling(source, i) for i in known if source.eq_type[i] == OF_JOINTS and source.eq_active0[i]]


def _coupling(source: Any, i: int) -> Coupling:
    """Return an equality: q1 - ref1 = c0 + c1 (q2 - ref2) + ...; of a line the joint that a control reaches leads."""
    first, second = int(source.eq_obj1id[i]), int(source.eq_obj2id[i])
    start, ratio, *bent = (float(c) for c in source.eq_data[i][:5])
    driven = [any(not is_passive(source, a) for a in at_joint(source, j)) for j in (first, second)]
    if second < 0 or not ratio or any(bent) or all(driven):
        return Coupling((first, second))
    refs = [float(source.qpos0[source.jnt_qposadr[j]]) for j in (first, second)]
    offset = start + refs[0] - ratio * refs[1]
    follower, leader = first, second
    if driven[0]:
        follower, leader, ratio, offset = second, first, 1.0 / ratio, -offset / ratio
    return Coupling((first, second), follower, Gear(source.joint(leader).name or f"joint{leader}", ratio, offset))
