"""Pages of discovered effects, read from a YAML file: a formula that is diagnosed, applied and simulated like any page.

schema: sher3.found/1
effect: found_drag
stage: motor_mechanics
sites: [delta_1]
explanation: an extra force on delta 1 that follows the square of the velocity
terms: [{component: 0, feature: signed_square(velocity), coefficient: 20.3e3, unit: N/(m/s)^2}]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import new_class
from typing import Any, ClassVar

import numpy as np
from sher3_common import FileError, dump_yaml, read_yaml
from sher3_common.errors import Sher3Error
from sher3_common.laws import LAWS
from sher3_description import ACTUATORS
from sher3_diagnosis.channel import AT_TIP, STAGES, Array, Channel
from sher3_diagnosis.discover.feature import Feature, parse
from sher3_diagnosis.discover.formula import Discovery
from sher3_diagnosis.effect import INPUTS, Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.found import FoundTerm, add_terms
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page

SCHEMA = "sher3.found/1"
SITES = (*ACTUATORS, "tip", "force_sensor")
"""Places of the SHER; any other is an axis or a joint of another machine."""
OTHERS = ("axis", "servo", "joint")
"""Kinds of machine, beside the SHER, whose views tell what a formula is made of."""
CONSTANTS = {
    "1": "offset",
    "itself(velocity)": "viscous",
    "itself(position)": "spring",
    "itself(acceleration)": "inertia",
}
"""Feature of a force -> constant of the equation of motion that its coefficient is."""
WIDEST = 100.0
"""Largest size of a coefficient in the plant, over that of the file."""
SHAPED = 10.0
"""The same, and its inverse, for a shape."""
KINDS = {"time": "time", "warmth": "temperature", "demand": "command", "load": "load", "law": "command"}
"""Quantity -> what it is among the inputs of an effect, where that has another name or must be told."""


@dataclass(frozen=True)
class SavedTerm:
    """One term as a file holds it."""

    component: int
    feature: Feature
    coefficient: float
    unit: str


class FoundPage(Page):
    """A formula as an effect: its coefficients are fitted again, its shapes searched around those of the file.

    Attributes:
        sites: where it was found.
        terms: of the formula.
    """

    family = "found"
    best = Best("sweep", "constant speeds over the whole stroke show most laws")
    leaves_out = "what a formula of few terms does not say"
    sites: ClassVar[tuple[str, ...]]
    terms: ClassVar[tuple[SavedTerm, ...]]

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return where the formula shows; nowhere but at its own sites."""
        return (Channel(self.stage, site),) if site in self.sites else ()

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the shapes of the file."""
        return [dict(self.shape)] if site in self.sites else []

    @cached_property
    def shape(self) -> dict[str, float]:
        """Name -> value of every shape that may be refined: equal values of a name count once."""
        found: dict[tuple[str, float], None] = {}
        for term in self.terms:
            for factor in term.feature.factors:
                for name, value in zip(LAWS[factor.law].shapes, factor.shape, strict=True):
                    found.setdefault((name, value))
        return {f"{name}_{k + 1}": value for k, (name, value) in enumerate(found)}

    def reshaped(self, feature: Feature, shape: Shape) -> Feature:
        """Return a feature of the file with other shapes."""
        values = {value: shape[name] for name, value in self.shape.items()}
        return feature.reshaped(tuple(values[s] for s in feature.shape))

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return one column for each term, from the quantities of the run; between two encoders one more, a constant.

        The constant stands for where the two are at the start, of which the formula says nothing.
        """
        stages = AT_TIP if self.stage in AT_TIP else (self.stage,)
        main = Channel(self.stage, site)
        quantities = view.recorded(main)
        width = 6 if site in SITES and site not in ACTUATORS else 1
        samples = len(view.at_residuals(np.zeros(view.run.ticks)))
        columns = np.zeros((samples, width, len(self.terms) + (self.stage == "transmission")))
        columns[:, :, len(self.terms) :] = 1.0
        for k, term in enumerate(self.terms):
            out = np.ones(samples)
            for factor in self.reshaped(term.feature, shape).factors:
                out = out * view.at_residuals(factor.along(quantities, view.step))
            columns[:, term.component, k] = out
        return Signature({Channel(stage, site): columns for stage in stages})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the coefficients of the terms, the first of (p,), in their order, and the values of the shape."""
        stated = coefficients[: len(self.terms)]
        return {f"coefficient_{k + 1}": float(c) for k, c in enumerate(stated)} | dict(shape)


def read_found(path: Path) -> FoundPage:
    """Read a page from a file.

    Raises:
        FileError: it cannot be read or is not of the schema; a formula in it is wrong.
    """
    data = read_yaml(path)
    if data.get("schema") != SCHEMA:
        raise FileError("is not a discovered effect", path=path, value=data.get("schema"), limit=SCHEMA,
                        remedy="name a file of `sher3 gap discover --save`")  # fmt: skip
    try:
        return _page(data, path)
    except (KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:  # a Sher3Error is a ValueError
        raise FileError("is not a discovered effect", path=path, value=f"{error}", remedy="correct the file") from error


def _page(data: Mapping[str, Any], path: Path) -> FoundPage:
    stage, sites = data["stage"], tuple(data["sites"])
    _require_known(stage, STAGES, "stage")
    terms = tuple(
        SavedTerm(int(t.get("component", 0)), parse(t["feature"]), float(t["coefficient"]), str(t["unit"]))
        for t in data["terms"]
    )
    if not terms or not all(np.isfinite(t.coefficient) for t in terms):
        raise Sher3Error("a formula has no term, or a coefficient that is not finite", remedy="correct the terms")
    own = [site in SITES for site in sites]
    if not sites or any(own) != all(own):
        raise Sher3Error(
            "sites of one machine are needed",
            value=", ".join(sites),
            limit=", ".join(SITES),
            remedy="name places of the SHER, or axes of another machine, not both",
        )
    place = sites[0] if own[0] and sites[0] not in ACTUATORS else "axis"
    most = 0 if place == "axis" else 5
    for t in terms:
        if not 0 <= t.component <= most:
            raise Sher3Error("no such component", value=t.component, limit=most, remedy="count components from 0")
    attributes = {
        "id": str(data["effect"]),
        "stage": stage,
        "kinds": (*(("robot",) if own[0] else ()), *(OTHERS if place == "axis" else ())),
        "places": (place,),
        "inputs": _inputs(terms),
        "explanation": str(data["explanation"]),
        "source": path.resolve(),
        "sites": sites,
        "terms": terms,
        "units": {f"coefficient_{k + 1}": t.unit for k, t in enumerate(terms)},
        "on_axis": _constants(terms) if stage == "motor_mechanics" else {},
    }
    kind: type[FoundPage] = type("Found", (FoundPage,), attributes)
    page: FoundPage = kind()
    kind.units = {**attributes["units"], **_shape_units(page)}
    kind.finer = {name: (0.9, 0.95, 1.05, 1.1) for name in page.shape}
    if own[0]:
        _in_plant(kind, page)
    return page


def _constants(terms: Sequence[SavedTerm]) -> dict[str, str]:
    """Return which coefficients of a force are constants of the equation of motion."""
    of = [("coulomb" if _is_dry(t.feature) else CONSTANTS.get(str(t.feature), "")) for t in terms]
    return {f"coefficient_{k + 1}": constant for k, constant in enumerate(of) if constant}


def _is_dry(feature: Feature) -> bool:
    return [(f.law, f.quantity) for f in feature.factors] == [("sliding", "position")]


def _require_known(value: object, limit: Sequence[str], what: str) -> None:
    if value not in limit:
        raise Sher3Error.unknown(f"no such {what}", value, limit)


def _inputs(terms: Sequence[SavedTerm]) -> tuple[str, ...]:
    """Return what the law depends on, in the words of `INPUTS`."""
    names = [(f.law, f.quantity) for t in terms for f in t.feature.factors]
    found = [KINDS.get(q, q if q in INPUTS else "posture") for _, q in names]
    found += ["direction" for law, q in names if law in ("sliding", "play") and q == "position"]
    return tuple(dict.fromkeys(found))


def _shape_units(page: FoundPage) -> dict[str, str]:
    """Return the units of the shapes: those of what they scale."""
    base = {"position": "m", "velocity": "m/s", "demand": "m/s", "time": "s", "warmth": "K", "work": "1"}
    base |= {"acceleration": "m/s^2", "force": "N", "load": "N", "effort": "N", "law": "N"}
    out = {}
    for name, value in page.shape.items():
        factor = next(f for t in page.terms for f in t.feature.factors if value in f.shape)
        unit = LAWS[factor.law].shape_units[factor.shape.index(value)]
        out[name] = base.get(factor.quantity.split(".")[-1], "1") if unit == "x" else unit
    return out


def _in_plant(kind: type[FoundPage], page: FoundPage) -> None:
    """Give a page its form in the plant: the same terms, evaluated live."""
    fields: dict[str, Any] = {}
    for k, term in enumerate(page.terms):
        most = WIDEST * max(abs(term.coefficient), np.finfo(float).tiny)
        text = f"of {term.feature}"
        fields[f"coefficient_{k + 1}"] = parameter(term.unit, term.coefficient, -most, most, text, fixed_unit=True)
    for name, value in page.shape.items():
        low, high = (value / SHAPED, value * SHAPED) if not name.startswith("centre") else (-SHAPED, SHAPED)
        fields[name] = parameter(kind.units[name], value, low, high, "shape of the law", fixed_unit=True)

    def apply(self: PlantEffect, p: PlantParameters) -> None:
        """Write the terms into the plant."""
        values = self.parameters
        terms = []
        for k, term in enumerate(page.terms):
            factors = [(f.law, f.quantity, f.shape) for f in page.reshaped(term.feature, values).factors]
            terms.append(FoundTerm(term.component, values[f"coefficient_{k + 1}"], factors))
        holder = p.axis[self.rows[0] : self.rows[0] + 1] if self.actuator in ACTUATORS else p.body
        add_terms(holder["found"][0], page.stage, terms)
        holder["found_any"] = True

    def body(namespace: dict[str, Any]) -> None:
        namespace.update(fields, apply=apply, __annotations__=dict.fromkeys(fields, float), __doc__=page.explanation)

    made = new_class("FoundInPlant", (PlantEffect,), {"page": kind, "sites": kind.sites}, body)
    kind.plant = dataclass(frozen=True)(made)


def save_found(discovery: Discovery, name: str, path: Path) -> None:
    """Write a discovered formula as a page that `read_found` reads.

    Raises:
        Sher3Error: nothing was found.
    """
    if not discovery.claimed:
        raise Sher3Error("nothing was found to save", value=str(discovery.channel), remedy="see the note")
    terms = [
        {"component": t.component, "feature": str(t.feature), "coefficient": float(f"{t.coefficient.value:.8g}"),
         "unit": t.coefficient.unit}
        for t in discovery.terms
    ]  # fmt: skip
    content = {
        "schema": SCHEMA,
        "effect": name,
        "stage": discovery.channel.stage,
        "sites": [discovery.channel.actuator],
        "explanation": "; ".join(discovery.sentences),
        "terms": terms,
    }
    path.write_text(dump_yaml(content), encoding="utf-8")
