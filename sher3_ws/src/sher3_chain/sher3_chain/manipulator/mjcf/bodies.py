"""The rigid bodies of an MJCF model as a tree."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_chain.manipulator.mjcf.gears import gears_of
from sher3_chain.manipulator.rigid.tree import WORLD, Link, Tree, moved, parameters

FREE, SLIDE, HINGE = 0, 2, 3
"""MuJoCo's numbers for the kinds of joint that are read (mjtJoint)."""
LIMITS_OFF = 1 << 3
"""Flag that takes the stops of all joints away (mjDSBL_LIMIT)."""
BALL = "write a ball joint as three hinges, or take it out where it is at rest"
BOLTED = "take its freejoint out where the robot is bolted down or hangs in a stand; one that walks is not judged"


def tree_from_mjcf(source: Any, label: str) -> Tree:
    """Return the rigid bodies, joints and rotors of an `MjModel`.

    A body that floats freely, as a thing to be grasped, is held where the model has it.

    Args:
        source: of MuJoCo.
        label: that errors name.

    Raises:
        MachineError: a joint is a ball, or sits on a body that floats.
    """
    links: list[Link] = []
    other, gears = {}, gears_of(source)
    floats: dict[int, str] = {}  # body below the world, by number -> how it moves
    carriers: list[tuple[int, Array, Array]] = [(WORLD, np.eye(3), np.zeros(3))]
    for body in range(1, source.nbody):
        parent, turn, place = carriers[source.body_parentid[body]]
        own, at = _pose(source.body_pos[body], source.body_quat[body])
        place, turn = place + turn @ at, turn @ own
        first, count = source.body_jntadr[body], source.body_jntnum[body]
        for joint in range(first, first + count):
            name, kind = source.joint(joint).name or f"joint{joint}", int(source.jnt_type[joint])
            root = source.body_rootid[body]
            if kind == FREE:
                other[name] = floats[root] = "a free joint"
                continue
            refused = BOLTED if root in floats else "" if kind in (SLIDE, HINGE) else BALL
            if refused:
                value = floats.get(root, "a ball joint")
                raise MachineError(f"{label}: joint {name} neither turns nor slides", value=value, remedy=refused)
            anchor, rotor = np.array(source.jnt_pos[joint]), float(source.dof_armature[source.jnt_dofadr[joint]])
            axis, zero = np.array(source.jnt_axis[joint]), float(source.qpos0[source.jnt_qposadr[joint]])
            slides = kind == SLIDE
            low, high = free_range(source, joint)
            at = place + turn @ (anchor - zero * axis if slides else anchor)  # drawn where the joint reads `ref`
            turn = turn if slides else turn @ Rotation.from_rotvec(-zero * axis).as_matrix()
            link = Link(name, "", parent, turn, at, axis, slides, rotor=rotor, low=low, high=high)
            links.append(replace(link, gear=gears.get(joint)))
            parent, turn, place = len(links) - 1, np.eye(3), -anchor
        carriers.append((parent, turn, place))
        if parent != WORLD:
            named = source.body(body).name or f"body{body}"
            links[parent] = links[parent].carrying(_inertia(source, body), turn, place, named)
    return Tree(tuple(links), np.array(source.opt.gravity), other)


def _inertia(source: Any, body: int) -> Array:
    """Inertial parameters of a body in its own frame, (10,)."""
    turn, centre = _pose(source.body_ipos[body], source.body_iquat[body])
    principal = np.diag(source.body_inertia[body])
    return moved(parameters(float(source.body_mass[body]), np.zeros(3), principal), turn, centre)


def _pose(position: Array, quaternion: Array) -> tuple[Array, Array]:
    """Orientation (3, 3) and origin (3,) of a position and a quaternion (w, x, y, z)."""
    return Rotation.from_quat(np.roll(quaternion, -1)).as_matrix(), np.array(position)


def free_range(source: Any, joint: int) -> tuple[float, float]:
    """Return the positions at which the stops of a joint of an `MjModel` begin to act; infinite without a stop."""
    if source.opt.disableflags & LIMITS_OFF or not source.jnt_limited[joint]:
        return -np.inf, np.inf
    low, high = map(float, source.jnt_range[joint])
    margin = float(source.jnt_margin[joint])
    return low + margin, high - margin
