"""Forces of a joint whose drive gives another force than it reports, in newtons that act.

The balance is one of reported forces: with force = (1 + g) * reported, a friction F leaves F / (1 + g) in it, and so
does a weight, a spring or a mass. Beside a gain that was found each of them is (1 + g) times its coefficient.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import pages

GAIN = "drive gain"
"""What a page scales that says how much force there is to what the drive reports."""
FORCEFUL = ("N", "kg")
"""Units of forces, of what a force is per path or speed, and of masses begin so."""


def in_true_force(causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes with forces and masses as they act on their joints.

    They stay as they are on a joint where no gain was found. A controller's gain in the place of a drive's is the same
    force. Where something else may stand in for the gain, such as another mass, forces stay as reported, which is right
    then, and their intervals hold both.
    """
    same_force = {page.id: {page.id, *page.indistinct} for page in pages("axis") if page.scales == GAIN}
    gains = {c.actuator: c for c in causes if c.effect in same_force}
    doubted = {joint for joint, c in gains.items() if not same_force[c.effect].issuperset(c.rivals)}
    return [
        _acting(c, gains[c.actuator].parameters["relative"], c.actuator in doubted) if c.actuator in gains else c
        for c in causes
    ]


def _acting(cause: Cause, gain: Parameter, doubted: bool) -> Cause:
    out = dict(cause.parameters)
    for name, p in cause.parameters.items():
        if p.unit.startswith(FORCEFUL):
            out[name] = _holding(p, _times(p, gain)) if doubted else _times(p, gain)
    return cause.model_copy(update={"parameters": out})


def _holding(parameter: Parameter, other: Parameter) -> Parameter:
    """Return a parameter whose interval holds that of another, too."""
    if parameter.low is None or parameter.high is None or other.low is None or other.high is None:
        return parameter
    low, high = min(parameter.low, other.low), max(parameter.high, other.high)
    return parameter.model_copy(update={"low": low, "high": high})


def _times(parameter: Parameter, gain: Parameter) -> Parameter:
    """Return a parameter times one more than a gain, whose own interval widens that of the product."""
    factor = 1.0 + gain.value
    value, low, high = factor * parameter.value, parameter.low, parameter.high
    if low is not None and high is not None:
        own = 0.0 if gain.low is None or gain.high is None else 0.5 * (gain.high - gain.low) * abs(parameter.value)
        below, above = (float(np.hypot(factor * side, own)) for side in (parameter.value - low, high - parameter.value))
        low, high = value - below, value + above
    return parameter.model_copy(update={"value": value, "low": low, "high": high})
