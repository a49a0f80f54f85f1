"""What the findings of both exact stages have in common: no floor but rounding, and intervals of ticks not told."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.thresholds import EXACT_UNTIMED
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Residual, Where
from sher3_effects import Page, computed


def exact_finding(where: Where, causes: list[Cause], closure: float) -> ExactFinding:
    """Return a finding; the floor of an exact stage is what its causes leave, since it has no other."""
    left = Residual(gap=where.floor, floor=where.floor, unit=where.unit)
    return ExactFinding(where, causes, exact_interval(closure), left)


def exact_place(stage: str, actuator: str, gap: float, floor: float, regime: str) -> Where:
    """Return the place of an error that is computed: there is no doubt that it is there."""
    return Where(stage=stage, actuator=actuator, gap=gap, floor=floor, unit="m/s", regime=regime, confidence=1.0)


def exact_interval(value: float) -> Interval:
    """Return the interval of a closure: the floor is exact, and only ticks without information widen it."""
    return Interval(value=value, low=value - EXACT_UNTIMED, high=min(1.0, value + EXACT_UNTIMED))


def computed_cause(parameter: str, value: Parameter, actuator: str, closure: float) -> Cause:
    """Return the cause that a computed parameter stands for."""
    return exact_cause(computed(parameter), actuator, closure, **{parameter: value})


def exact_cause(page: Page, actuator: str, closure: float, **parameters: Parameter) -> Cause:
    """Return a cause of an exact stage; family and stage are those of the effect's page."""
    return Cause(
        effect=page.id,
        family=page.family,
        stage=page.stage,
        actuator=actuator,
        parameters=parameters,
        closure=exact_interval(float(np.clip(closure, 0.0, 1.0))),
    )
