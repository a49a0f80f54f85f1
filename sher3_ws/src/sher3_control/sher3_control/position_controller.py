"""The host law of the position modes, contract section 3, in the order of operations that the recorded runs use.

qd_cmd(k) = qd_ref(k) + position_gain * (q_ref(k) - q_load(k)), then each axis clamped to +-limits.velocity.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled


@compiled
def position_law(q_ref: float, qd_ref: float, q_load: float, gain: float, limit: float) -> float:
    """Return the commanded velocity of one axis [m/s or rad/s] for finite inputs; callable from compiled code."""
    return min(max(qd_ref + gain * (q_ref - q_load), -limit), limit)


@compiled
def position_command(
    q_ref: tuple[float, ...],
    qd_ref: tuple[float, ...],
    q_load: tuple[float, ...],
    gain: float,
    limit: tuple[float, ...],
) -> tuple[float, ...]:
    """Return the commanded velocities of the five axes."""
    return (
        position_law(q_ref[0], qd_ref[0], q_load[0], gain, limit[0]),
        position_law(q_ref[1], qd_ref[1], q_load[1], gain, limit[1]),
        position_law(q_ref[2], qd_ref[2], q_load[2], gain, limit[2]),
        position_law(q_ref[3], qd_ref[3], q_load[3], gain, limit[3]),
        position_law(q_ref[4], qd_ref[4], q_load[4], gain, limit[4]),
    )


def position_commands(
    q_ref: NDArray[np.float64],
    qd_ref: NDArray[np.float64],
    q_load: NDArray[np.float64],
    gain: float,
    limit: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the law over recordings of shape (n, 5): the same bits as `position_command` tick by tick."""
    return np.minimum(np.maximum(qd_ref + gain * (q_ref - q_load), -limit), limit)
