"""The signal chain: every stage and place with its gap over floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.localise.gaps import Gap
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.reporter import Reporter
from sher3_diagnosis.verdict import Where
from sher3_diagnosis.words import place, quantity, ratio_text, words

NOT_RECORDED, AT_FLOOR, NEAR, GAP = range(4)
"""Levels of a cell."""
CLOSE = 0.75
"""Power over its threshold from which a place at the floor is shown as close to a gap."""


@dataclass(frozen=True)
class Cell:
    """One place in one stage: its name, text, level, tooltip, and the numbers below where there is a gap."""

    label: str
    text: str
    level: int
    tip: str
    below: str = ""


@dataclass(frozen=True)
class Column:
    """One stage of the diagram."""

    name: str
    flow: str
    cells: Sequence[Cell]

    @property
    def level(self) -> int:
        """The worst of its cells."""
        return max((c.level for c in self.cells), default=NOT_RECORDED)


def chain(diagnosis: Diagnosis, reporter: Reporter) -> list[Column]:
    """Return the diagram's columns in the order of the signal."""
    exact = reporter.exact_places([f.evidence for f in diagnosis.findings])
    columns = []
    for stage in reporter.stages:
        found = next((f.where for f in diagnosis.exact if f.where.stage == stage), None)
        if stage in exact:
            cells = _exact(found, exact[stage])
        else:
            cells = _measured(diagnosis, stage, reporter)
            cells = cells if found is None else [_failed(found.actuator, found), *cells]
        if not cells and reporter.every_stage:
            cells = [Cell("all axes" if stage in exact else "", "not recorded", NOT_RECORDED, "")]
        if cells:
            columns.append(Column(words(stage), reporter.flows.get(stage, ""), cells))
    return columns


def _exact(found: Where | None, places: Sequence[str]) -> list[Cell]:
    """Return the cells of a stage that is computed to rounding."""
    fine = "re-executed to rounding"
    hit = [found is not None and found.actuator in (name, "all") for name in places]
    return [
        _failed(name, found) if failed and found is not None else Cell(place(name), "exact", AT_FLOOR, fine)
        for name, failed in zip(places, hit, strict=True)
    ]


def _failed(name: str, found: Where) -> Cell:
    return Cell(place(name), quantity(found.gap, found.unit), GAP, found.regime)


def _measured(diagnosis: Diagnosis, stage: str, reporter: Reporter) -> list[Cell]:
    """Return the cells of a stage whose floor is measured."""
    order = {name: k for k, name in enumerate(reporter.places)}
    found = [(g, f.evidence) for f in diagnosis.findings for g in f.gaps if g.channel.stage == stage]
    found.sort(key=lambda x: (order.get(x[0].channel.actuator, len(order)), x[0].channel.actuator))
    return [_cell(gap, evidence) for gap, evidence in found]


def _cell(gap: Gap, evidence: Evidence) -> Cell:
    unit = evidence.unit(gap.channel, gap.component)
    level = GAP if gap.significant else (NEAR if gap.power > CLOSE else AT_FLOOR)
    size, floor = quantity(gap.gap, unit), quantity(gap.floor, unit)
    below = f"{size} over {floor}" if gap.significant else ""
    return Cell(place(gap.channel.actuator), ratio_text(gap.ratio), level, f"gap {size}, floor {floor} rms", below)
