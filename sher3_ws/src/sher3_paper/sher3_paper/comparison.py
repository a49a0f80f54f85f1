"""One line of the report: what the paper prints, what is computed here, and the verdict."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Literal

Verdict = Literal["reproduced", "within band", "differs", "inconsistent", "computed", "not run"]


@dataclass(frozen=True)
class Comparison:
    """A printed value beside a computed one.

    Attributes:
        quantity: Name of the quantity.
        unit: Unit of both values.
        printed: Value in the paper; None where it prints none.
        computed: Value computed here; None where nothing ran.
        verdict: `reproduced` within the tolerance of printing, `within band` of a stated wider one, `differs`,
            `inconsistent` (the paper contradicts itself, see `note`), `computed` (nothing printed), `not run`.
        command: Command that makes the computed value.
        note: Tolerance, definition, or the id of an inconsistency.
    """

    quantity: str
    unit: str
    printed: float | None
    computed: float | None
    verdict: Verdict
    command: str
    note: str = ""

    @property
    def difference(self) -> float | None:
        """Computed minus printed, or None."""
        if self.printed is None or self.computed is None:
            return None
        return self.computed - self.printed

    def to_dict(self) -> dict[str, Any]:
        """Return the line as plain data."""
        return {**asdict(self), "difference": self.difference}


def compare(
    quantity: str, unit: str, printed: float, computed: float, tolerance: float, command: str, note: str = ""
) -> Comparison:
    """Return a comparison that is `reproduced` when the values differ by at most `tolerance`."""
    verdict: Verdict = "reproduced" if abs(computed - printed) <= tolerance else "differs"
    return Comparison(quantity, unit, printed, float(computed), verdict, command, note or f"within {tolerance:g}")


def within(
    quantity: str, unit: str, limit: float, computed: float, command: str, note: str = "", printed: float | None = None
) -> Comparison:
    """Return a comparison whose computed magnitude must not exceed a stated limit."""
    verdict: Verdict = "within band" if abs(computed) <= limit else "differs"
    return Comparison(quantity, unit, printed, float(computed), verdict, command, note or f"band {limit:g}")


def computed(quantity: str, unit: str, value: float, command: str, note: str = "") -> Comparison:
    """Return a value the paper does not print."""
    return Comparison(quantity, unit, None, float(value), "computed", command, note)


@dataclass(frozen=True)
class Table:
    """A table that is shown whole: a title, column names and rows of text or numbers."""

    title: str
    columns: list[str]
    rows: list[list[Any]]


@dataclass
class Section:
    """One part of the report.

    Attributes:
        name: Name by which `--only` chooses it.
        title: Heading.
        text: What was done, one paragraph.
        comparisons: Lines with a printed beside a computed value.
        tables: Further tables.
        figures: Names of the functions of `figures` that draw it, with their arguments.
    """

    name: str
    title: str
    text: str
    comparisons: list[Comparison] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: list[tuple[str, dict[str, Any]]] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """Return the section as plain data, without figures."""
        return {
            "name": self.name,
            "title": self.title,
            "comparisons": [line.to_dict() for line in self.comparisons],
            "tables": [asdict(table) for table in self.tables],
        }
