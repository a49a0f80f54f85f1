"""Temperatures over a case: the room has two time constants, and the body of the robot lags behind the room."""

from __future__ import annotations

import numpy as np

from sher3_challenge.plants.plant import Array, Climate

FAST_SHARE, FAST = 0.2, 0.2
"""Share of the rise that comes fast, and its time constant over the climate's own."""
LAG = 15.0
"""Time by which the body lags behind the room [s], against some 260 s of a case."""


def temperatures(climate: Climate, stamp: int, time: Array) -> tuple[Array, Array]:
    """Return what thermometer and body have, (n,) each [degC], over a run's own time, which starts at `stamp` [ns]."""
    since = np.maximum(0.0, (stamp - climate.origin) * 1e-9 + time)
    room, body = np.full(len(time), climate.start), np.full(len(time), climate.start)
    for share, constant in ((1 - FAST_SHARE, climate.constant), (FAST_SHARE, FAST * climate.constant)):
        slow = np.exp(-since / constant)
        room += climate.rise * share * (1 - slow)
        lagged = (constant * slow - LAG * np.exp(-since / LAG)) / (constant - LAG)
        body += climate.rise * share * (1 - lagged)
    return room, body
