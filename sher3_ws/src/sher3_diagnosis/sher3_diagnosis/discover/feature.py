"""Features: products of laws of recorded quantities, written as `sliding(position, 5e-06) * itself(load)`.

The text is what a saved page of the library holds, and what the simulator evaluates.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from sher3_common.errors import Sher3Error
from sher3_common.laws import LAWS, MOST_FACTORS, walk

from sher3_diagnosis.channel import Array


class FormulaError(Sher3Error):
    """A formula that cannot be read, or asks for a quantity that is not there."""


class Quantity(NamedTuple):
    """One recorded or derived signal of a run.

    Attributes:
        values: (n,) at the samples of the record.
        unit: SI.
        words: its name in a sentence.
        kind: what it is to a law: "place" a position, "speed", "force", "command" what is asked for, "change" how much
            of it is new, "clock" a time, or "state" anything else.
        own: whether it belongs to the place that is looked at.
    """

    values: Array
    unit: str
    words: str
    kind: str
    own: bool = True


Quantities = Mapping[str, Quantity]


@dataclass(frozen=True, order=True)
class Factor:
    """A law of one quantity with its shape parameters."""

    law: str
    quantity: str
    shape: tuple[float, ...] = ()

    def __str__(self) -> str:
        return f"{self.law}({', '.join([self.quantity, *(f'{s:.6g}' for s in self.shape)])})"

    def along(self, quantities: Quantities, period: float) -> Array:
        """Return the factor along a run whose samples are `period` apart, (n,); raises FormulaError."""
        if self.quantity not in quantities:
            raise FormulaError.unknown("no such quantity here", self.quantity, sorted(quantities))
        a, b = (*self.shape, 0.0, 0.0)[:2]
        return walk(LAWS[self.law].code, a, b, np.ascontiguousarray(quantities[self.quantity].values), period)


@dataclass(frozen=True, order=True)
class Feature:
    """A product of factors; without factors it is the constant 1."""

    factors: tuple[Factor, ...] = ()

    def __str__(self) -> str:
        return " * ".join(map(str, self.factors)) or "1"

    @property
    def shape(self) -> tuple[float, ...]:
        """Shape parameters of all factors in order."""
        return tuple(s for f in self.factors for s in f.shape)

    def reshaped(self, shape: tuple[float, ...]) -> Feature:
        """Return the feature with other shape parameters."""
        left, factors = list(shape), []
        for factor in self.factors:
            n = len(factor.shape)
            factors.append(replace(factor, shape=tuple(left[:n])))
            del left[:n]
        return Feature(tuple(factors))

    @property
    def numbers(self) -> int:
        """How many words it takes: one for the coefficient, one for each factor that is not plain, its shapes."""
        return 1 + sum(f.law != "itself" for f in self.factors) + max(0, len(self.factors) - 1) + len(self.shape)

    def unit(self, units: Mapping[str, str], of: str) -> str:
        """Return the unit of the coefficient: that of the gap, `of`, over the feature's."""
        power: dict[str, int] = {}
        for factor in self.factors:
            law, unit = LAWS[factor.law], units[factor.quantity]
            if law.power and unit != "1":
                power[unit] = power.get(unit, 0) + law.power
            if factor.law == "rate":
                power["1/s"] = power.get("1/s", 0) + 1
        if tuple(power) in ((f"{of}/s",), (of,)) and 1 in power.values():
            return "s" if f"{of}/s" in power else "1"
        if list(power.values()) == [1] and f"{next(iter(power))}/s" == of:
            return "1/s"
        below = [f"({u})" if "/" in u or "*" in u else u for u in power]
        parts = [b if p == 1 else f"{b}^{p}" for b, p in zip(below, power.values(), strict=True)]
        return of if not parts else f"{of}/{parts[0]}" if len(parts) == 1 else f"{of}/({' '.join(parts)})"


def parse(text: str) -> Feature:
    """Return the feature of a text.

    Raises:
        FormulaError: it is no product of known laws, or has too many factors.
    """
    try:
        tree = ast.parse(str(text).strip(), mode="eval").body
    except SyntaxError as error:
        raise FormulaError("is no product of laws", value=text, remedy="as in square(velocity)") from error
    factors = tuple(_factor(node, text) for node in _product(tree) if not _is_one(node))
    if len(factors) > MOST_FACTORS:
        raise FormulaError("too many factors", value=len(factors), limit=MOST_FACTORS, remedy="write fewer factors")
    return Feature(factors)


def _product(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return [*_product(node.left), *_product(node.right)]
    return [node]


def _is_one(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1


def _factor(node: ast.expr, text: str) -> Factor:
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args):
        raise FormulaError("is no product of laws", value=text, remedy="as in square(velocity)")
    law, (quantity, *shape) = node.func.id, node.args
    if law not in LAWS:
        raise FormulaError.unknown("no such law", law, LAWS)
    try:
        numbers = tuple(float(ast.literal_eval(s)) for s in shape)
    except (ValueError, TypeError) as error:
        raise FormulaError(
            "a shape parameter is no number",
            value=text,
            remedy="write numbers behind the quantity, as in sliding(position, 5e-06)",
        ) from error
    wanted = LAWS[law].shapes
    if len(numbers) != len(wanted) or not all(map(np.isfinite, numbers)):
        limit = ", ".join(wanted) or "none"
        raise FormulaError(
            f"{law} has other shape parameters", value=text, limit=limit, remedy="give as many numbers as it names"
        )
    if any(not n > 0.0 for n, name in zip(numbers, wanted, strict=True) if name != "centre"):
        raise FormulaError("a shape parameter is not above zero", value=text, limit=0, remedy="give a larger number")
    return Factor(law, ast.unparse(quantity), numbers)
