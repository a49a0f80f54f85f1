"""From the causes of a verdict to effects of the simulator."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description import Robot
from sher3_diagnosis.verdict import Cause
from sher3_sim.effect import PlantEffect

from sher3_effects.page import Part
from sher3_effects.registry import library, plants


def to_effects(causes: Sequence[Cause], robot: Robot) -> list[PlantEffect]:
    """Return effects of the plant with the fitted parameters, clipped to what the plant allows.

    The plant takes an effect once per actuator: of parts that name the same one, the first stays. Causes without a form
    in the plant are left out.
    """
    out: dict[tuple[str, str], PlantEffect] = {}
    for cause in causes:
        values = {name: p.value for name, p in cause.parameters.items()}
        page = library().get(cause.effect)
        for part in page.to_simulator(cause.actuator, values, robot) if page and page.plant else ():
            made = _made(part)
            out.setdefault((made.id, made.actuator), made)
    return list(out.values())


def _made(part: Part) -> PlantEffect:
    """Return one effect of the plant: of the values those the plant knows; the others are explanation only."""
    kind = plants()[part.effect]
    site = part.actuator if part.actuator in kind.sites else kind.sites[0]
    given = {}
    for name, spec in kind.specification(site).items():
        if name in part.parameters:
            given[name] = min(max(part.parameters[name], spec.low), spec.high)
        elif spec.low <= 0.0 <= spec.high:
            given[name] = 0.0
    return kind(site, **given)
