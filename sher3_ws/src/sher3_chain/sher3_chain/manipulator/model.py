"""The rigid-body model of a serial arm, read from URDF or MJCF: the force that a motion needs, and what a payload adds.

Pinocchio (Carpentier et al., SII 2019) computes both; the columns of a body's inertial parameters are those of its
joint torque regressor.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_chain.manipulator.bodies import Bodies, slides
from sher3_chain.manipulator.mjcf.losses import Losses

PARAMETERS = 10
"""Inertial parameters of a body: mass, mass times centre (3), inertia about its joint (6), as Pinocchio orders them."""
MOVING = ("revolute", "prismatic")


@dataclass(frozen=True)
class ArmModel:
    """A model reduced to the joints that were recorded; all others are locked at zero.

    Attributes:
        pinocchio: the reduced model.
        names: of the k recorded joints, in the order of the description.
        parameters: inertial ones of all links in place of the model's, (10 links,); None: those of the model.
        losses: what an MJCF model says beside its bodies; None: nothing.
    """

    pinocchio: pin.Model
    names: tuple[str, ...]
    parameters: Array | None = None
    losses: Losses | None = None

    @cached_property
    def rows(self) -> list[int]:
        """Velocity index of every recorded joint."""
        return [self.pinocchio.joints[self.pinocchio.getJointId(n)].idx_v for n in self.names]

    @cached_property
    def links(self) -> tuple[str, ...]:
        """Name of the first link that each joint moves, in the order of the joints of the model."""
        first: dict[int, str] = {}
        for frame in self.pinocchio.frames:
            if frame.type == pin.FrameType.BODY:
                first.setdefault(frame.parentJoint, frame.name)
        return tuple(first.get(j, self.pinocchio.names[j]) for j in range(1, self.pinocchio.njoints))

    @cached_property
    def linear(self) -> tuple[bool, ...]:
        """Whether each recorded joint slides."""
        return tuple(slides(self.pinocchio.joints[self.pinocchio.getJointId(n)]) for n in self.names)

    def regressor(self, q: Array, v: Array, a: Array) -> Array:
        """Return the force that each inertial parameter asks of each recorded joint, (n, k, 10 links).

        Args:
            q: positions of the recorded joints, (n, k).
            v: their velocities.
            a: their accelerations.
        """
        model, data = self.pinocchio, self.pinocchio.createData()
        full = [self._full(x) for x in (q, v, a)]
        out = np.empty((len(q), len(self.names), PARAMETERS * (model.njoints - 1)))
        for i, (qi, vi, ai) in enumerate(zip(*full, strict=True)):
            out[i] = pin.computeJointTorqueRegressor(model, data, self._configuration(qi), vi, ai)[self.rows]
        return out

    @cached_property
    def inertial(self) -> Array:
        """Inertial parameters of the model, (10 links,)."""
        return np.concatenate([b.toDynamicParameters() for b in list(self.pinocchio.inertias)[1:]])

    @property
    def mass(self) -> float:
        """Mass of all links that move, kg."""
        return float(sum(b.mass for b in list(self.pinocchio.inertias)[1:]))

    def needed(self, q: Array, v: Array, a: Array) -> Array:
        """Return the force that each recorded joint needs, (n, k): inverse dynamics, with rotors and springs."""
        at_rest = 0.0 if self.losses is None else self.losses.at_rest(q)
        return self._rigid(q, v, a) + at_rest

    def _rigid(self, q: Array, v: Array, a: Array) -> Array:
        model, data = self.pinocchio, self.pinocchio.createData()
        if self.parameters is not None:
            return self.regressor(q, v, a) @ self.parameters + np.asarray(model.armature)[self.rows] * a
        full = [self._full(x) for x in (q, v, a)]
        forces = [pin.rnea(model, data, self._configuration(qi), vi, ai) for qi, vi, ai in zip(*full, strict=True)]
        return np.array(forces)[:, self.rows]

    def inertia_matrix(self, q: Array) -> Array:
        """Return the joint-space inertia of the recorded joints in one posture q (k,), (k, k)."""
        model = self.pinocchio
        upper = np.triu(pin.crba(model, model.createData(), self._configuration(self._full(q[None])[0])))
        return np.asarray(upper + np.triu(upper, 1).T)[np.ix_(self.rows, self.rows)]

    def _full(self, x: Array) -> Array:
        """Spread the recorded joints (n, k) over the degrees of freedom of the model (n, nv)."""
        out = np.zeros((len(x), self.pinocchio.nv))
        out[:, self.rows] = x
        return out

    def _configuration(self, positions: Array) -> Array:
        """Configuration (nq,) of joint positions (nv,): a joint without limits is stored as cosine and sine."""
        return np.asarray(pin.integrate(self.pinocchio, self._neutral, positions))

    @cached_property
    def _neutral(self) -> Array:
        return np.asarray(pin.neutral(self.pinocchio))


def arm_model(
    bodies: Bodies, names: Sequence[str], gravity: tuple[float, float, float] | None, stated: Collection[str] = ()
) -> ArmModel:
    """Return a model whose joints are locked but for the recorded ones.

    Args:
        bodies: of the URDF or MJCF file.
        names: of the recorded joints.
        gravity: in place of the model's, m/s^2.
        stated: joints whose damping is known from elsewhere; that of an MJCF file does not count.

    Raises:
        MachineError: the model has no such joint, a joint of it neither turns nor slides, or it states no masses.
    """
    path, model, source = bodies.label, bodies.pinocchio, bodies.mujoco
    missing = [n for n in names if not model.existJointName(n)]
    if missing:
        have = ", ".join(list(model.names)[1:])
        raise MachineError(
            f"{path}: no joint {missing[0]!r}", limit=f"joints: {have}", remedy="name the joints as the model does"
        )
    for n in names:
        joint = model.joints[model.getJointId(n)]
        if joint.nv != 1:
            raise MachineError(
                f"{path}: joint {n} neither turns nor slides", value=joint.shortname(), remedy="leave it out"
            )
    locked = [j for j in range(1, model.njoints) if model.names[j] not in names]
    try:
        reduced = pin.buildReducedModel(model, locked, pin.neutral(model)) if locked else model
    except ValueError as error:  # a joint and a link of one name, which Pinocchio cannot tell apart
        remedy = "give joints and links names of their own, or list every joint"
        raise MachineError(f"{path}: joints cannot be locked", value=str(error)[:120], remedy=remedy) from error
    if gravity is not None:
        reduced.gravity.linear = np.array(gravity)
    if not any(b.mass > 0.0 for b in list(reduced.inertias)[1:]):
        raise MachineError(f"{path}: states no masses", value="0 kg", remedy="give a model with inertias")
    return ArmModel(reduced, tuple(names), losses=None if source is None else Losses(source, names, stated))
