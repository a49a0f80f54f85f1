"""Discovered formulas in the plant: sums of terms, each a product of laws of quantities, evaluated as they were fitted.

A term is a row of numbers: where it acts, its coefficient, and for each factor law, quantity and two shapes. The laws
are those of `sher3_common.laws`, so a formula is the same thing to the diagnosis and to the plant.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.laws import EARLIER, LAWS, MOST_FACTORS, law_value
from sher3_description import ACTUATORS

from sher3_sim.errors import EffectError

Array = np.ndarray
AXIS_TERMS, BODY_TERMS = 8, 36
"""Terms that an axis, and tip and force sensor together, can hold."""
HEAD = 4
"""Numbers of a row before its factors: 1 and up where it acts (0: unused), component, coefficient, factors."""
ROW = HEAD + 4 * MOST_FACTORS
DRIVE, MOTOR, TRANSMISSION, TIP, SENSOR, SENT, ASKED = 1, 2, 3, 4, 5, 6, 7
ACTS = {
    "controller": ASKED,
    "transport": SENT,
    "drive": DRIVE,
    "motor_mechanics": MOTOR,
    "transmission": TRANSMISSION,
    "mechanism": TIP,
    "structure": TIP,
    "sensing": SENSOR,
}
"""Stage -> where its formula acts in the plant."""
OWN = ("position", "velocity", "acceleration", "demand", "effort", "force", "load", "warmth", "time", "work", "law")
POSITION, VELOCITY, ACCELERATION, DEMAND, EFFORT, FORCE, LOAD, WARMTH, TIME, WORK, LAW = range(11)
PASSED_ON = ("command", "wanted", "reading")
"""What is compared with itself some ticks earlier: the command as it is sent, what the host's law asks for, and the
reading of the load encoder that it works with."""
COMMAND, WANTED, READING = range(3)
ERROR = len(OWN)
GIVEN = ERROR + 1
"""First of what is passed on, each with its changes behind it; the error of position is before them."""
CHANGES = 1 + len(EARLIER)
"""Quantities of each."""
OTHERS = GIVEN + len(PASSED_ON) * CHANGES
"""First of the other axes' quantities."""
AXIS_QUANTITIES = (
    *OWN,
    "error",
    *(name for x in PASSED_ON for name in (x, *(f"{x}.change_{n}" for n in EARLIER))),
    *(f"{a}.{q}" for a in ACTUATORS for q in OWN[:3]),
)
BODY_QUANTITIES = (
    *(f"{q}.{k}" for q in ("tip", "contact", "touch", "speed", "push") for k in "xyz"),
    *(f"tool.{row}{column}" for row in "xyz" for column in "xyz"),
    *("warmth", "time"),
    *(f"{a}.{q}" for q in OWN[:2] for a in ACTUATORS),
)


class FoundTerm(NamedTuple):
    """One term for the plant: component 0 on an axis; factors of law, quantity and shapes."""

    component: int
    coefficient: float
    factors: Sequence[tuple[str, str, tuple[float, ...]]]


def add_terms(rows: Array, stage: str, terms: Sequence[FoundTerm]) -> None:
    """Write terms into free rows (k, ROW) of an axis or of the body.

    Raises:
        EffectError: the stage or a quantity is not one that the plant can express, or there is no room.
    """
    if stage not in ACTS:
        remedy = "use the formula to explain, not to simulate"
        raise EffectError("the plant cannot express a formula at this stage", value=stage, limit=", ".join(ACTS),
                          remedy=remedy)  # fmt: skip
    known = BODY_QUANTITIES if ACTS[stage] in (TIP, SENSOR) else AXIS_QUANTITIES
    for term in terms:
        free = np.flatnonzero(rows[:, 0] == 0.0)
        if not len(free):
            raise EffectError("the plant holds no more terms there", value=len(rows) + 1, limit=len(rows))
        row = rows[free[0]]
        row[:HEAD] = ACTS[stage], term.component, term.coefficient, len(term.factors)
        for k, (law, quantity, shape) in enumerate(term.factors):
            if quantity not in known:
                raise EffectError("the plant has no such quantity there", value=quantity, limit=", ".join(known))
            first = HEAD + 4 * k
            row[first : first + 4] = LAWS[law].code, known.index(quantity), *(*shape, 0.0, 0.0)[:2]


@compiled
def term_value(row: Array, inputs: Array, last: Array, memory: Array, period: float) -> float:
    """Return a term's value; `last` (factors,) and `memory` (factors, 2) are its own and change."""
    value = row[2]
    for k in range(int(row[3])):
        j = HEAD + 4 * k
        x = inputs[int(row[j + 1])]
        factor = law_value(int(row[j]), row[j + 2], row[j + 3], x, x - last[k], memory[k], period)
        last[k] = x
        value *= factor
    return value


@compiled
def forget(rows: Array, inputs: Array, last: Array, memory: Array) -> None:
    """Begin at rest: nothing moved before the first look."""
    for i in range(len(rows)):
        for k in range(int(rows[i, 3])):
            last[i, k] = inputs[int(rows[i, HEAD + 4 * k + 1])]
            memory[i, k, :] = 0.0


@compiled
def total(rows: Array, acts: int, inputs: Array, last: Array, memory: Array, period: float) -> float:
    """Return the sum of an axis' terms that act at one place."""
    out = 0.0
    for i in range(len(rows)):
        if rows[i, 0] == acts:
            out += term_value(rows[i], inputs, last[i], memory[i], period)
    return out


@compiled
def add_body(rows: Array, acts: int, s: Any, period: float, out: Array) -> None:
    """Add the terms at the tip or the force sensor to `out` (6,)."""
    for i in range(len(rows)):
        if rows[i, 0] == acts:
            out[int(rows[i, 1])] += term_value(rows[i], s.found_inputs, s.found_last[i], s.found_memory[i], period)
