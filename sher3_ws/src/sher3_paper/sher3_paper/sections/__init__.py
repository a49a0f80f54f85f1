"""The parts of the report, one file each; a part is a function that returns a `Section`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sher3_paper.comparison import Section
from sher3_paper.errors import BadData
from sher3_paper.sections.benchtop import benchtop
from sher3_paper.sections.compensation import deflection_compensation
from sher3_paper.sections.design import design
from sher3_paper.sections.geometry import geometry
from sher3_paper.sections.grasp import grasp
from sher3_paper.sections.identification import identification
from sher3_paper.sections.torsion import torsion

SECTIONS: dict[str, Callable[[], Section]] = {
    "geometry": geometry,
    "torsion": torsion,
    "identification": identification,
    "design": design,
    "grasp": grasp,
    "compensation": deflection_compensation,
}
"""Every part that needs nothing but this software, in the order of the report."""


def build(only: list[str] | None = None, benchtop_results: Path | None = None) -> list[Section]:
    """Compute the chosen parts, by default all.

    Args:
        only: names of parts, `benchtop` included.
        benchtop_results: JSON written by a bench-top evaluation; without it that part says that it has not run.

    Raises:
        BadData: an unknown part.
    """
    names = [*SECTIONS, "benchtop"]
    for name in only or []:
        if name not in names:
            raise BadData("part of the report", value=name, limit=", ".join(names), remedy="choose one of these")
    chosen = [name for name in names if not only or name in only]
    return [benchtop(benchtop_results) if name == "benchtop" else SECTIONS[name]() for name in chosen]
