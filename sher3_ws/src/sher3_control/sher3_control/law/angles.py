"""Roll and tilt angle from the actuator positions: all that the cooperative law needs to know about the pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tilt_angle


@compiled
def roll_and_tilt(parameters: NDArray[np.float64], q_roll: float, q_tilt: float) -> tuple[float, float]:
    """Return both angles [rad]; the tilt is NaN where the linkage cannot close, beyond a dead point.

    Args:
        parameters: kernel parameters as an array (44,).
        q_roll: position of the roll actuator [rad].
        q_tilt: position of the tilt actuator [m].
    """
    p = unpack(parameters)
    return q_roll + p.zero_4, tilt_angle(p, q_tilt)
