"""Actuators of an MJCF model that no control reaches: constant forces, springs, cogging and friction of a motor.

A `dcmotor` without inputs gives A sin(n l + phase) - K^2 / R w - friction, with l and w the length and speed of its
transmission (MuJoCo's technical note on the DC motor); a gain of zero leaves an affine bias.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

FIXED, AFFINE, NONE = 0, 1, 0
"""MuJoCo's numbers of an actuator's laws: fixed gain, affine bias, no dynamics."""
MOTOR = "mjBIAS_DCMOTOR"
"""MuJoCo's name of the bias of a motor with cogging and friction; older versions have none."""
JOINTS = (0, 1)
"""MuJoCo's numbers of transmissions that end at a joint (mjtTrn)."""


def at_joint(source: Any, joint: int) -> list[int]:
    """Return the actuators of an `MjModel` that sit on a joint, by number."""
    count = getattr(source, "nactuator", source.nu)  # from 4.0 on an actuator may have no control, or several
    kinds, ends = source.actuator_trntype, source.actuator_trnid
    return [i for i in range(count) if kinds[i] in JOINTS and ends[i][0] == joint]


def is_passive(source: Any, actuator: int) -> bool:
    """Return whether no control reaches an actuator: it has none, or a gain of zero."""
    inputs = getattr(source, "actuator_ctrlnum", None)
    if inputs is not None and inputs[actuator] == 0:
        return True
    plain = source.actuator_gaintype[actuator] == FIXED and source.actuator_dyntype[actuator] == NONE
    return bool(plain and source.actuator_gainprm[actuator][0] == 0.0)


class Passive:
    """The forces of such actuators on the k joints of a model."""

    def __init__(self, source: Any, joints: Sequence[int], motor: int | None) -> None:
        """Take what an `MjModel` has on joints, by number; `motor` is the number of its bias of a motor."""
        self._source, self._motor = source, motor
        self._of = [[i for i in at_joint(source, j) if is_passive(source, i)] for j in joints]

    def force(self, q: Array, v: Array) -> Array:
        """Return the force on each joint at positions and velocities (n, k), (n, k)."""
        out = np.zeros_like(q)
        for k, actuators in enumerate(self._of):
            for i in actuators:
                gear = float(self._source.actuator_gear[i][0])
                out[:, k] += gear * self._actuator_force(i, gear * q[:, k], gear * v[:, k])
        return out

    def _actuator_force(self, i: int, length: Array, speed: Array) -> Array:
        bias, gain = self._source.actuator_biasprm[i], self._source.actuator_gainprm[i]
        if self._source.actuator_biastype[i] == AFFINE:
            return np.asarray(bias[0] + bias[1] * length + bias[2] * speed)
        if self._source.actuator_biastype[i] != self._motor:
            return np.zeros_like(length)
        resistance, constant = gain[:2]
        amplitude, poles, phase, coulomb, static, stribeck = bias[:6]
        slow = np.exp(-((speed / stribeck) ** 2)) if stribeck > 0.0 else 0.0
        friction = np.sign(speed) * (coulomb + (static - coulomb) * slow)
        braked = constant**2 / resistance * speed if resistance > 0.0 else 0.0
        return np.asarray(amplitude * np.sin(poles * length + phase) - braked - friction)
