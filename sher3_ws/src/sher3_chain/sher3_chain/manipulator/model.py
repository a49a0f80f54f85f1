"""The rigid-body model of a serial arm, read from URDF or MJCF: the force that a motion needs, and what a payload adds.

The columns of a body's inertial parameters are those of the joint torque regressor.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_chain.manipulator.bodies import Bodies
from sher3_chain.manipulator.description import Carried
from sher3_chain.manipulator.mjcf.losses import Losses
from sher3_chain.manipulator.rigid import dynamics
from sher3_chain.manipulator.rigid.gears import Geared, geared
from sher3_chain.manipulator.rigid.tree import PARAMETERS, Tree

__all__ = ["PARAMETERS", "ROUNDED", "ArmModel", "arm_model"]

ROUNDED = 1e-9
"""Force on a joint over that on the joint that feels most, below which it is what rounding leaves of nothing."""


@dataclass(frozen=True)
class ArmModel:
    """A model reduced to the joints that were recorded and those that follow them; all others are locked at zero.

    Attributes:
        tree: of the joints that move.
        names: of the k recorded joints, in the order of the description.
        parameters: inertial ones of all links in place of the model's, (10 links,); None: those of the model.
        carried: inertial ones of known masses on the links, (10 links,), which are nobody's error; None: nothing.
        losses: what an MJCF model says beside its bodies; None: nothing.
    """

    tree: Tree
    names: tuple[str, ...]
    parameters: Array | None = None
    carried: Array | None = None
    losses: Losses | None = None

    @cached_property
    def geared(self) -> Geared:
        """The recorded joints with those that follow them."""
        return geared(self.tree, self.names)

    @cached_property
    def rows(self) -> list[int]:
        """Number of every recorded joint in the tree."""
        return [self.tree.names.index(name) for name in self.names]

    @cached_property
    def links(self) -> tuple[str, ...]:
        """Name of the first link that each joint moves, in the order of the joints of the model."""
        return tuple(link.body or link.name for link in self.tree.links)

    def carrying(self, known: Carried | None) -> ArmModel:
        """Return the arm with a known mass on a link; raises MachineError where no link that moves is called so."""
        if known is None:
            return self
        if known.link not in self.links:
            limit, remedy = ", ".join(self.links), "name a link of the model that moves"
            raise MachineError("`carried` names no link", value=known.link, limit=limit, remedy=remedy)
        found = np.zeros(self.inertial.size) if self.carried is None else self.carried.copy()
        centre = np.array(known.centre)
        found[self.of(known.link)] += known.mass * np.concatenate([[1.0], centre, point_inertia(centre)])
        return replace(self, carried=found)

    def of(self, link: str) -> slice:
        """Return where the inertial parameters of a link are."""
        first = PARAMETERS * self.links.index(link)
        return slice(first, first + PARAMETERS)

    @cached_property
    def linear(self) -> tuple[bool, ...]:
        """Whether each recorded joint slides."""
        return tuple(self.tree.links[row].slides for row in self.rows)

    @cached_property
    def ranges(self) -> Array:
        """Positions at which the stops of each recorded joint begin to act, (k, 2), rad or m; infinite without."""
        return np.array([(self.tree.links[row].low, self.tree.links[row].high) for row in self.rows])

    def regressor(self, q: Array, v: Array, a: Array) -> Array:
        """Return the force that each inertial parameter asks of each recorded joint, (n, k, 10 links).

        Args:
            q: positions of the recorded joints, (n, k).
            v: their velocities.
            a: their accelerations.
        """
        return self._felt(dynamics.regressor(self.tree, *self._full(q, v, a)))

    @cached_property
    def inertial(self) -> Array:
        """Inertial parameters of the model, (10 links,)."""
        return self.tree.inertial

    def mass_of(self, link: str) -> float:
        """Return the mass of a link, kg, as the model has it."""
        return float(self.inertial[self.of(link)][0])

    @property
    def mass(self) -> float:
        """Mass of all links that move, kg."""
        return float(self.inertial[::PARAMETERS].sum())

    def needed(self, q: Array, v: Array, a: Array) -> Array:
        """Return the force that each recorded joint needs, (n, k): inverse dynamics, with rotors and springs."""
        at_rest = 0.0 if self.losses is None else self.losses.at_rest(q)
        return self._rigid(q, v, a) + at_rest

    def weight(self, q: Array) -> Array:
        """Return the force that each recorded joint needs to hold the bodies up, (n, k), less what is compensated.

        A spring of the model is no weight. Of a joint that holds none, rounding leaves none either.
        """
        still = np.zeros_like(q)
        bodies = self._rigid(q, still, still)
        held = bodies + (0.0 if self.losses is None else self.losses.compensated(q))
        most = np.abs(bodies).max(initial=0.0)
        return np.where(np.abs(held).max(axis=0, initial=0.0) > ROUNDED * most, held, 0.0)

    def inertia_matrix(self, q: Array) -> Array:
        """Return the joint-space inertia of the recorded joints in postures q (..., k), (..., k, k)."""
        k = q.shape[-1]
        unit = np.tile(np.eye(k), (q.size // k, 1))
        posture = np.repeat(q.reshape(-1, k), k, axis=0)
        still = np.zeros_like(unit)
        columns = self._rigid(posture, still, unit) - self._rigid(posture, still, still)
        return np.swapaxes(columns.reshape(*q.shape, k), -1, -2)

    def _rigid(self, q: Array, v: Array, a: Array) -> Array:
        own = self.inertial if self.parameters is None else self.parameters
        own = own if self.carried is None else own + self.carried
        return self._felt(dynamics.forces(self.tree, own, *self._full(q, v, a))) + self.rotors * a

    @cached_property
    def rotors(self) -> Array:
        """Inertia of the drive at each recorded joint, (k,), kg or kg m^2."""
        return np.array([self.tree.links[row].rotor for row in self._order]) @ self.geared.ratios**2

    @cached_property
    def _order(self) -> list[int]:
        return [self.tree.names.index(name) for name in self.geared.names]

    def _full(self, q: Array, v: Array, a: Array) -> list[Array]:
        """Motion (n, k) of the recorded joints as that of all joints of the tree, in its order."""
        every = (self.geared.places(q), self.geared.moving(v), self.geared.moving(a))
        return [x[:, np.argsort(self._order)] for x in every]

    def _felt(self, forces: Array) -> Array:
        """Forces on the joints of the tree as the recorded joints feel them."""
        return self.geared.felt(forces[:, self._order])


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
    path, tree, source = bodies.label, bodies.tree, bodies.mujoco
    for n in names:
        if n in tree.other:
            kind = tree.other[n]
            raise MachineError(f"{path}: joint {n} neither turns nor slides", value=kind, remedy="leave it out")
        if n not in tree.names:
            have = ", ".join(tree.names)
            remedy = "name the joints as the model does"
            raise MachineError(f"{path}: no joint {n!r}", limit=f"joints: {have}", remedy=remedy)
    reduced = tree.only([*names, *tree.followers(names)])
    if gravity is not None:
        reduced = replace(reduced, gravity=np.array(gravity))
    if not any(reduced.inertial[::PARAMETERS] > 0.0):
        raise MachineError(f"{path}: states no masses", value="0 kg", remedy="give a model with inertias")
    losses = None if source is None else Losses(source, geared(reduced, names), stated)
    return ArmModel(reduced, tuple(names), losses=losses)


def point_inertia(centre: Array) -> Array:
    """Return the inertia of a kilogram at `centre` (3,), m, about the origin: xx xy yy xz yz zz, (6,), as Pinocchio's.

    I = |c|^2 1 - c c^T.
    """
    x, y, z = centre
    return np.array([y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y])
