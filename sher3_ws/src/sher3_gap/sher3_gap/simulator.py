"""From the causes of a verdict to effects of the simulator."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description import Robot
from sher3_sim.effects import EFFECTS, Effect

from sher3_gap.verdict import Cause


def to_effects(causes: Sequence[Cause], robot: Robot) -> list[Effect]:
    """Effects of the plant with the fitted parameters, clipped to what the plant allows."""
    return [to_effect(cause, robot) for cause in causes]


def to_effect(cause: Cause, robot: Robot) -> Effect:
    """One effect of the plant: parameters the simulator knows by the same name; the others are explanation only."""
    kind = EFFECTS[cause.effect]
    actuator = cause.actuator if cause.actuator in kind.places else kind.places[0]
    specification = kind.specification(actuator)
    values = {}
    for name, spec in specification.items():
        if name in cause.parameters:
            values[name] = min(max(cause.parameters[name].value, spec.low), spec.high)
        elif spec.low <= 0.0 <= spec.high:
            values[name] = 0.0
    return kind(actuator, **values)
