"""What discovered formulas see of the plant at a tick: the quantities the diagnosis knows from a recording."""

from __future__ import annotations

from typing import Any

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.laws import EARLIER
from sher3_description.contract import REFERENCE_TEMPERATURE

from sher3_sim.found import (
    ACCELERATION,
    ASKED,
    CHANGES,
    COMMAND,
    DEMAND,
    EFFORT,
    ERROR,
    FORCE,
    GIVEN,
    LAW,
    LOAD,
    OTHERS,
    POSITION,
    READING,
    SENT,
    TIME,
    VELOCITY,
    WANTED,
    WARMTH,
    WORK,
    forget,
    total,
)

Array = np.ndarray


@compiled
def look_at_axes(axis: Any, b: Any, state: Any, s: Any) -> None:
    """Write the quantities of every axis with a formula; at the first tick its laws begin at rest."""
    needed = False
    for i in range(5):
        needed = needed or axis[i].found_any
    if not needed:
        return
    motion = np.empty((5, 3))
    work = 0.0
    for i in range(5):
        a, x = axis[i], state[i]
        acceleration = (x.velocity - x.found_velocity) / b.period if s.tick > 0 else 0.0
        x.found_velocity = x.velocity
        motion[i, 0], motion[i, 1], motion[i, 2] = x.position, x.velocity, acceleration
        force = a.mass * acceleration + a.viscous * x.velocity + s.load[i]
        x.found_inputs[FORCE], x.found_inputs[LOAD] = force, s.load[i]
        work += abs(force) / a.limit
    for i in range(5):
        inputs = state[i].found_inputs
        inputs[POSITION], inputs[VELOCITY], inputs[ACCELERATION] = motion[i, 0], motion[i, 1], motion[i, 2]
        inputs[DEMAND], inputs[EFFORT], inputs[LAW] = state[i].demand, state[i].integral, state[i].integral
        inputs[WARMTH], inputs[TIME] = b.temperature - REFERENCE_TEMPERATURE, s.tick * b.period
        inputs[WORK] = work
        for j in range(5):
            for k in range(3):
                inputs[OTHERS + 3 * j + k] = motion[j, k]
        if s.tick == 0:
            forget(axis[i].found, inputs, state[i].found_last, state[i].found_memory)


@compiled
def look_at_tip(b: Any, s: Any, state: Any, wrench: Array, tip_rate: Array, rotation: Array, position: Array) -> None:
    """Write the quantities of tip and force sensor; at the first tick their laws begin at rest."""
    x = s.found_inputs
    for k in range(3):
        x[k], x[3 + k], x[9 + k] = position[k], wrench[k], tip_rate[k]
        x[6 + k] = rotation[0, k] * wrench[0] + rotation[1, k] * wrench[1] + rotation[2, k] * wrench[2]
        x[12 + k] = (tip_rate[k] - s.tip_rate[k]) / b.period if s.tick > 0 else 0.0
        for j in range(3):
            x[15 + 3 * k + j] = rotation[k, j]
    x[24], x[25] = b.temperature - REFERENCE_TEMPERATURE, s.tick * b.period
    for i in range(5):
        x[26 + i], x[31 + i] = state[i].load, state[i].velocity
    if s.tick == 0:
        forget(b.found, x, s.found_last, s.found_memory)


@compiled
def sent(a: Any, x: Any, command: float, period: float) -> float:
    """Return the command of a tick as the formulas of the transport leave it."""
    if not a.found_any:
        return command
    _pass_on(x, COMMAND, command)
    return command + total(a.found, SENT, x.found_inputs, x.found_last, x.found_memory, period)


@compiled
def asked(a: Any, x: Any, wanted: float, setpoint: float, reading: float, period: float) -> float:
    """Return the command that the host's law asks for as the formulas of the controller leave it."""
    if not a.found_any:
        return wanted
    x.found_inputs[ERROR] = setpoint - reading
    _pass_on(x, WANTED, wanted)
    _pass_on(x, READING, reading)
    return wanted + total(a.found, ASKED, x.found_inputs, x.found_last, x.found_memory, period)


@compiled
def _pass_on(x: Any, which: int, value: float) -> None:
    """Write what is passed on at a tick, and how much of it is new since some ticks earlier."""
    past, first = x.found_past[which], GIVEN + which * CHANGES
    x.found_inputs[first] = value
    for k in range(len(EARLIER)):
        x.found_inputs[first + 1 + k] = value - past[EARLIER[k] - 1]
    for k in range(len(past) - 1, 0, -1):
        past[k] = past[k - 1]
    past[0] = value


@compiled
def begin_at_rest(x: Any, reading: float) -> None:
    """Let a run begin with the reading as it was long before, and with commands of zero."""
    for k in range(x.found_past.shape[1]):
        x.found_past[READING, k] = reading
