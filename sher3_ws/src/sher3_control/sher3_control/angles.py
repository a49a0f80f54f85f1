"""Roll and tilt angle from the actuator positions: all that the cooperative law needs to know of the robot's pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tilt_angle

from .compiled import compiled


@compiled
def roll_and_tilt(parameters: NDArray[np.float64], q_roll: float, q_tilt: float) -> tuple[float, float]:
    """Return both angles [rad] for the kernel parameters as an array (44,); NaN beyond a dead point."""
    p = unpack(parameters)
    return q_roll + p.zero_4, tilt_angle(p, q_tilt)
