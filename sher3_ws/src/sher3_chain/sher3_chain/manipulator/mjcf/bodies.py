"""The rigid bodies of an MJCF model as a Pinocchio model."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

SLIDE, HINGE = 2, 3
"""MuJoCo's numbers for the kinds of joint that are read (mjtJoint)."""
REMEDIES = {
    0: "take its freejoint out where the robot is bolted down or hangs in a stand; one that walks is not judged",
    1: "write a ball joint as three hinges, or take it out where it is at rest",
}
"""Number of another kind -> what to do about it."""


def model_from_mjcf(source: Any, label: str) -> pin.Model:
    """Return the rigid bodies, joints and rotors of an `MjModel` as a Pinocchio model.

    Args:
        source: of MuJoCo.
        label: that errors name.

    Raises:
        MachineError: a joint neither turns nor slides.
    """
    model = pin.Model()
    model.gravity.linear = np.array(source.opt.gravity)
    carrier: list[tuple[int, pin.SE3]] = [(0, pin.SE3.Identity())]
    armature: list[float] = []
    for body in range(1, source.nbody):
        parent, placed = carrier[source.body_parentid[body]]
        pose = placed * _pose(source.body_pos[body], source.body_quat[body])
        first, count = source.body_jntadr[body], source.body_jntnum[body]
        for joint in range(first, first + count):
            parent, pose = _add(model, source, joint, parent, pose, label)
            armature.append(float(source.dof_armature[source.jnt_dofadr[joint]]))
        carrier.append((parent, pose))
        inertia = _inertia(source, body).se3Action(pose)
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        name = source.body(body).name or f"body{body}"
        model.addFrame(pin.Frame(name, parent, 0, pose, pin.FrameType.BODY, pin.Inertia.Zero()))
    model.armature = np.array(armature)
    return model


def _add(model: pin.Model, source: Any, joint: int, parent: int, pose: pin.SE3, label: str) -> tuple[int, pin.SE3]:
    """Add a joint; its frame sits at its anchor. Return it, and the body's pose in that frame."""
    kinds = {SLIDE: pin.JointModelPrismaticUnaligned, HINGE: pin.JointModelRevoluteUnaligned}
    kind, name = int(source.jnt_type[joint]), source.joint(joint).name or f"joint{joint}"
    if kind not in kinds:
        value = "a free joint" if kind == 0 else "a ball joint"
        raise MachineError(f"{label}: joint {name} neither turns nor slides", value=value, remedy=REMEDIES[kind])
    anchor = pin.SE3(np.eye(3), np.array(source.jnt_pos[joint]))
    made = model.addJoint(parent, kinds[kind](np.array(source.jnt_axis[joint])), pose * anchor, name)
    model.addJointFrame(made)  # by which Pinocchio finds a joint that is kept where others are locked
    return made, anchor.inverse()


def _inertia(source: Any, body: int) -> pin.Inertia:
    turn = _pose(source.body_ipos[body], source.body_iquat[body])
    principal = np.diag(source.body_inertia[body])
    return pin.Inertia(float(source.body_mass[body]), np.zeros(3), principal).se3Action(turn)


def _pose(position: Array, quaternion: Array) -> pin.SE3:
    """Transform of a position and a quaternion (w, x, y, z)."""
    w, x, y, z = map(float, quaternion)
    return pin.SE3(pin.Quaternion(w, x, y, z).toRotationMatrix(), np.array(position))
