"""Forces of an MJCF model beside its rigid bodies, as MuJoCo computes them: springs, gravity compensation, losses,
and actuators that no control reaches.
"""

from __future__ import annotations

from collections.abc import Collection
from copy import copy
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.mjcf.passive import MOTOR, Passive
from sher3_chain.manipulator.mjcf.reading import mujoco
from sher3_chain.manipulator.rigid.gears import Geared


class Losses:
    """What the joints of a model need beside the force on its rigid bodies.

    `frictionloss` is a soft constraint of MuJoCo: it turns over the speeds that its `solref` gives, so its own inverse
    dynamics say how large it is. Contacts, limits and equalities are left out: joints are judged in free motion.

    Attributes:
        full: dry friction of the k recorded joints in motion, (k,), N or N m.
    """

    def __init__(self, source: Any, moving: Geared, stated: Collection[str] = ()) -> None:
        """Take a copy of an `MjModel`; the damping of `stated` joints is known from elsewhere and left out."""
        api = mujoco()
        self._moving = moving
        self._model = copy(source)
        flags = api.mjtDisableBit
        for flag in (flags.mjDSBL_CONTACT, flags.mjDSBL_LIMIT, flags.mjDSBL_EQUALITY):
            self._model.opt.disableflags |= int(flag)
        self._lag = 0.0  # s, by which the speed of a step lies before that of central differences
        if self._model.opt.integrator != api.mjtIntegrator.mjINT_RK4:
            self._model.opt.enableflags |= int(api.mjtEnableBit.mjENBL_INVDISCRETE)
            self._lag = 0.5 * float(self._model.opt.timestep)
        joints = [self._model.joint(name) for name in moving.names]
        self._places = np.array([int(j.qposadr[0]) for j in joints])
        self._rows = np.array([int(j.dofadr[0]) for j in joints])
        bias = api.mjtBias.__members__.get(MOTOR)
        self._passive = Passive(self._model, [j.id for j in joints], None if bias is None else int(bias))
        self.full = self._model.dof_frictionloss[self._rows] @ np.abs(moving.ratios)
        for joint in joints:
            if joint.name in stated:
                self._model.dof_damping[joint.dofadr[0]] = 0.0

    def at_rest(self, q: Array) -> Array:
        """Return the force that springs, gravity compensation and cogging leave to the drives at q (n, k), (n, k)."""
        still = np.zeros_like(q)
        return -self._forces(q, still, still)[0]

    def compensated(self, q: Array) -> Array:
        """Return the force that gravity compensation takes off the drives at q (n, k), (n, k)."""
        still, pull = np.zeros_like(q), self._model.opt.gravity.copy()
        with_gravity = self._forces(q, still, still)[0]
        self._model.opt.gravity[:] = 0.0
        without = self._forces(q, still, still)[0]
        self._model.opt.gravity[:] = pull
        return without - with_gravity

    def in_motion(self, q: Array, v: Array) -> Array:
        """Return the force that damping and drag need at positions and velocities (n, k), (n, k)."""
        return -self._forces(q, v, np.zeros_like(q))[0] - self.at_rest(q)

    def dry(self, q: Array, v: Array, a: Array) -> Array:
        """Return the force that dry friction needs at positions, velocities and accelerations (n, k), (n, k)."""
        if not (self._model.dof_frictionloss.any() or self._model.tendon_frictionloss.any()):
            return np.zeros_like(q)
        return -self._forces(q, v - self._lag * a, a)[1]

    def _forces(self, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
        """Return passive forces and those of dry friction as the recorded joints feel them, (n, k) each."""
        api = mujoco()
        data = api.MjData(self._model)
        q, v, a = self._moving.places(q), self._moving.moving(v), self._moving.moving(a)
        passive, dry = np.empty_like(q), np.empty_like(q)
        place, speed, growth, lost, rubbed = data.qpos, data.qvel, data.qacc, data.qfrc_passive, data.qfrc_constraint
        for i, (qi, vi, ai) in enumerate(zip(q, v, a, strict=True)):
            place[self._places], speed[self._rows], growth[self._rows] = qi, vi, ai
            api.mj_inverse(self._model, data)
            passive[i], dry[i] = lost[self._rows], rubbed[self._rows]
        return self._moving.felt(passive + self._passive.force(q, v)), self._moving.felt(dry)
