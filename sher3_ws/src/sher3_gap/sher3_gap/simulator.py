"""From the causes of a verdict to effects of the simulator."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description import Robot
from sher3_sim.effects import EFFECTS, Effect

from sher3_gap.conversion import convert
from sher3_gap.verdict import Cause


def to_effects(causes: Sequence[Cause], robot: Robot) -> list[Effect]:
    """Effects of the plant with the fitted parameters, clipped to what the plant allows.

    The plant takes an effect once per actuator: of parts that name the same one, the first stays.
    """
    out: dict[tuple[str, str], Effect] = {}
    for cause in causes:
        values = {name: p.value for name, p in cause.parameters.items()}
        for effect, actuator, parameters in convert(cause.effect, cause.actuator, values, robot):
            made = _effect(effect, actuator, parameters)
            out.setdefault((made.id, made.actuator), made)
    return list(out.values())


def _effect(effect: str, actuator: str, values: dict[str, float]) -> Effect:
    """One effect of the plant: parameters the simulator knows; the others are explanation only."""
    kind = EFFECTS[effect]
    place = actuator if actuator in kind.places else kind.places[0]
    given = {}
    for name, spec in kind.specification(place).items():
        if name in values:
            given[name] = min(max(values[name], spec.low), spec.high)
        elif spec.low <= 0.0 <= spec.high:
            given[name] = 0.0
    return kind(place, **given)
