"""What an effect is to the plant: a small frozen object that changes one stage of it.

The plant knows no effect by name. The page of an effect, in `sher3_effects`, holds its form in the plant.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, NamedTuple, cast

from sher3_description import ACTUATORS, Robot

from sher3_sim.errors import EffectError
from sher3_sim.parameters import PlantParameters, nominal_parameters

SLIDERS: tuple[str, ...] = ACTUATORS[:3]
EVERYWHERE: tuple[str, ...] = (*ACTUATORS, "all")
SITES: Mapping[str, tuple[str, ...]] = {
    "axis": ACTUATORS,
    "leg": SLIDERS,
    "tilt": ("tilt",),
    "tip": ("tip",),
    "force_sensor": ("force_sensor",),
}
"""Kind of place -> sites of the robot."""

REVOLUTE: Mapping[str, tuple[str, float]] = {
    "m": ("rad", 30.0),
    "m/s": ("rad/s", 30.0),
    "N": ("N*m", 1 / 40),
    "N/m": ("N*m/rad", 1 / 1200),
    "N/(m/s)": ("N*m/(rad/s)", 1 / 1200),
    "m/N": ("rad/(N*m)", 1200.0),
    "kg": ("kg*m^2", 1 / 500),
}
"""Unit on the revolute axis, and what bounds and defaults are multiplied by there: leads and rated forces differ so."""


Change = Callable[[Any, float], Any]
"""What is there, over the axes that an effect sits on, and a parameter of it -> what is there then."""


def set_to(now: Any, value: float) -> Any:
    """Return the value, whatever was there."""
    return value


def scaled_by(now: Any, relative: float) -> Any:
    """Return what is larger by a share."""
    return now * (1.0 + relative)


class Parameter(NamedTuple):
    """Specification of one parameter.

    Attributes:
        unit: SI unit on a linear axis.
        default: value when none is given.
        low, high: smallest and largest value the plant takes.
        text: what it is.
        fixed_unit: whether the unit stays the same on an axis that turns.
        on: constant of the axis, of `sher3_sim.parameters.AXIS`, that it changes; "" where the effect says itself how.
        change: how, from what is there and the value.
    """

    unit: str
    default: float
    low: float
    high: float
    text: str
    fixed_unit: bool = False
    on: str = ""
    change: Change = operator.add

    def at(self, actuator: str) -> Parameter:
        """Return the specification on an actuator: units of the roll axis are rotary."""
        if actuator != "roll" or self.fixed_unit or self.unit not in REVOLUTE:
            return self
        unit, scale = REVOLUTE[self.unit]
        return self._replace(unit=unit, default=self.default * scale, low=self.low * scale, high=self.high * scale)


_UNSET = cast(float, object())


def parameter(unit: str, default: float, low: float, high: float, text: str, **more: Any) -> Any:
    """Declare a parameter of an effect: a float field with its specification, the `more` of it by name."""
    return field(default=_UNSET, metadata={"parameter": Parameter(unit, default, low, high, text, **more)})


@dataclass(frozen=True)
class PlantEffect:
    """One effect in the plant, on one actuator (or `tip`, `force_sensor`, `all`), with its parameters in SI units.

    A parameter that is not given takes its default. A subclass names the page of the effect, from which it has id,
    family and stage, and says how it changes PlantParameters, where its parameters do not say that themselves:
    `class BacklashInPlant(PlantEffect, page=Backlash)`.

    Raises:
        EffectError: the actuator is not one of `sites`, or a parameter is not finite or out of its bounds.
    """

    actuator: str

    id: ClassVar[str]
    family: ClassVar[str]
    stage: ClassVar[str]
    sites: ClassVar[tuple[str, ...]]

    def __init_subclass__(cls, *, page: Any, sites: tuple[str, ...] = ()) -> None:
        """Take the data sheet of the page, which knows its form in the plant as `page.plant` from then on.

        Args:
            page: with id, family, stage and places.
            sites: where the plant takes the effect; default all sites of the page's places.
        """
        cls.id, cls.family, cls.stage = page.id, page.family, page.stage
        cls.sites = sites or tuple(site for place in page.places for site in SITES[place])
        page.plant = cls

    def __post_init__(self) -> None:
        if self.actuator not in self.sites:
            where = ", ".join(self.sites)
            raise EffectError(f"{self.id} cannot sit on this actuator", value=self.actuator, limit=where)
        for name, spec in self.specification(self.actuator).items():
            value = getattr(self, name)
            if value is _UNSET:
                value = spec.default
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise EffectError(f"{self.id}: {name} is not a number", value=value, remedy=f"give it in {spec.unit}")
            if not (math.isfinite(value) and spec.low <= value <= spec.high):
                limit = f"{spec.low:.6g} ... {spec.high:.6g} {spec.unit}"
                remedy = f"check the unit: {spec.text}"
                raise EffectError(f"{self.id}: {name} is out of bounds", value=value, limit=limit, remedy=remedy)
            object.__setattr__(self, name, float(value))

    @classmethod
    def specification(cls, actuator: str) -> dict[str, Parameter]:
        """Return the parameters by name, with the units, bounds and defaults they have on an actuator."""
        return {f.name: f.metadata["parameter"].at(actuator) for f in fields(cls) if "parameter" in f.metadata}

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter values by name."""
        return {name: getattr(self, name) for name in self.specification(self.actuator)}

    @property
    def rows(self) -> list[int]:
        """Rows of the AXIS records the effect sits on: one, or all five for `all`."""
        return [ACTUATORS.index(self.actuator)] if self.actuator in ACTUATORS else list(range(len(ACTUATORS)))

    def apply(self, p: PlantParameters) -> None:
        """Write the effect into the plant's parameters; default what its own parameters say of the axis."""
        for name, spec in self.specification(self.actuator).items():
            if spec.on:
                p.axis[spec.on][self.rows] = spec.change(p.axis[spec.on][self.rows], getattr(self, name))


def with_effects(robot: Robot, effects: Iterable[PlantEffect]) -> PlantParameters:
    """Return the nominal parameters with the effects applied, in any order with the same result.

    Raises:
        EffectError: the same effect twice on one actuator.
    """
    p = nominal_parameters(robot)
    seen = set()
    for effect in effects:
        key = (effect.id, effect.actuator)
        if key in seen:
            raise EffectError(
                "the same effect twice on one actuator", value=" on ".join(key), remedy="keep one of them"
            )
        seen.add(key)
        effect.apply(p)
    return p
