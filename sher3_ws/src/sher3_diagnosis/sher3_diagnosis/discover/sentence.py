"""A term of a formula in plain language."""

from __future__ import annotations

from sher3_common.laws import LAWS

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.discover.feature import Factor, Quantities
from sher3_diagnosis.discover.formula import FoundTerm
from sher3_diagnosis.words import place, quantity

NAMES = {
    "controller": "an extra command to",
    "transport": "an extra demand of",
    "drive": "an extra effort of the drive on",
    "motor_mechanics": "an extra force on",
    "transmission": "the load ahead of the motor on",
    "mechanism": "the tip shifted at",
    "structure": "the tip shifted at",
    "sensing": "a reading too high at",
}
COMPONENTS = {"sensing": ("fx", "fy", "fz", "tx", "ty", "tz")}
POSE = ("x", "y", "z", "rx", "ry", "rz")


def component_name(channel: Channel, component: int) -> str:
    """Return the name of a component; empty where there is one alone."""
    if channel.actuator not in ("tip", "force_sensor"):
        return ""
    return COMPONENTS.get(channel.stage, POSE)[component]


def sentence(term: FoundTerm, channel: Channel, quantities: Quantities) -> str:
    """Return a term as a sentence without a full stop: what, where, in proportion to what, how much."""
    name = component_name(channel, term.component)
    where = f"{NAMES.get(channel.stage, 'a difference at')} {place(channel.actuator)}{f' along {name}' if name else ''}"
    parts = [_clause(f, quantities) for f in term.feature.factors]
    how = f" in proportion to {' times '.join(parts)}" if parts else " that is constant"
    return f"{where}{how}, {per(term)}"


def per(term: FoundTerm) -> str:
    """Return the coefficient as it is said: `3.2 N per (m/s)^2`."""
    c = term.coefficient
    above, _, below = c.unit.partition("/")
    return f"{quantity(c.value, above)} per {below}" if below else quantity(c.value, c.unit)


def _clause(factor: Factor, quantities: Quantities) -> str:
    found = quantities[factor.quantity]
    law = LAWS[factor.law]
    shapes = []
    for value, unit in zip(factor.shape, law.shape_units, strict=True):
        shapes.append(quantity(value, found.unit if unit == "x" else unit))
    return law.words.format(*shapes, x=found.words)
