"""The host law of the position modes (recorded-run contract, section 3).

qd_cmd(k) = qd_ref(k) + position_gain * (q_ref(k) - q_load(k)), then each axis is clamped to +-limits.velocity.
The order of operations is that of the recorded runs, so that their commands come out bit for bit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled


@compiled
def position_law(q_ref: float, qd_ref: float, q_load: float, gain: float, limit: float) -> float:
    """Return the commanded velocity of one axis [m/s or rad/s]; compiled code may call it.

    Args:
        q_ref: reference position [m or rad].
        qd_ref: feed-forward velocity [m/s or rad/s].
        q_load: position of the load encoder [m or rad].
        gain: [1/s].
        limit: largest magnitude of the result [m/s or rad/s].
    """
    return min(max(qd_ref + gain * (q_ref - q_load), -limit), limit)


@compiled
def position_command(
    q_ref: tuple[float, ...],
    qd_ref: tuple[float, ...],
    q_load: tuple[float, ...],
    gain: float,
    limit: tuple[float, ...],
) -> tuple[float, ...]:
    """Return the commanded velocities (5,) of one tick; arguments as in `position_law`, (5,) each but the gain."""
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
    """Return the commanded velocities of a recording, shape (n, 5).

    Arguments as in `position_law`, of shape (n, 5) but for the gain and for `limit` (5,). The result has the same bits
    as `position_command` called tick by tick.
    """
    return np.minimum(np.maximum(qd_ref + gain * (q_ref - q_load), -limit), limit)
