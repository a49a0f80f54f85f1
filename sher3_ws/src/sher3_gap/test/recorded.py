"""Runs written down by hand: a few ticks, five axes, no simulator."""

from __future__ import annotations

import numpy as np
from sher3_description import load_robot
from sher3_gap.signals import RunSignals

ROBOT = load_robot()
PERIOD = ROBOT.control_period


def run(ticks: int = 400, **signals: object) -> RunSignals:
    """Return a run at rest; signals are given as (n, 5) arrays, or as one row that is held."""
    given = {"name": "run", "excitation": "sweep", "repeat": 0, "period": PERIOD, **signals}
    wide = {k: np.broadcast_to(v, (ticks, 5)).copy() for k, v in given.items() if k in AXES}
    motor = wide.pop("motor", np.zeros((ticks, 5)))
    plain = {k: v for k, v in given.items() if k not in AXES}
    return RunSignals(stage_clock=PERIOD * np.arange(ticks), motor=motor, **wide, **plain)


AXES = {"motor", "effort", "reference", "reference_velocity", "command", "echo", "load"}


def stroke(ticks: int = 400, size: float = 1e-3, hertz: float = 2.0) -> np.ndarray:
    """Return a sine on all axes, (n, 5)."""
    return np.repeat(size * np.sin(2 * np.pi * hertz * PERIOD * np.arange(ticks))[:, None], 5, axis=1)
