"""The signal chain: every stage and actuator with its gap over floor."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_description import ACTUATORS

from sher3_gap.channels import STAGES, unit_of
from sher3_gap.diagnose import Diagnosis
from sher3_gap.report.style import STAGE_NAMES, place, quantity, ratio_text

INPUTS = {
    "transport": "command → demand",
    "controller": "set-point → command",
    "drive": "demand → force",
    "motor_mechanics": "force ↔ motion",
    "transmission": "motor → load encoder",
    "mechanism": "load encoders → tip",
    "structure": "load → tip deflection",
    "sensing": "truth → wrench reading",
}
ORDER = ("controller", "transport", *STAGES[2:])
"""Stages as the signal runs: the host computes before it sends."""


@dataclass(frozen=True)
class Cell:
    """One actuator in one stage: text, how bad (0 none recorded, 1 at floor, 2 near, 3 gap), tooltip, numbers below."""

    label: str
    text: str
    level: int
    tip: str
    below: str = ""


@dataclass(frozen=True)
class Stage:
    """One column of the diagram."""

    name: str
    flow: str
    cells: list[Cell]
    level: int


def stages(diagnosis: Diagnosis) -> list[Stage]:
    """Return the diagram's columns in the order of the signal."""
    built = []
    for name in ORDER:
        cells = _exact(diagnosis, name) if name in ("transport", "controller") else _measured(diagnosis, name)
        built.append(Stage(STAGE_NAMES[name], INPUTS[name], cells, max((c.level for c in cells), default=0)))
    return built


def _exact(diagnosis: Diagnosis, stage: str) -> list[Cell]:
    runs = diagnosis.evidence.runs
    needs = ("command", "echo") if stage == "transport" else ("command", "reference", "load")
    if not any(all(getattr(run, n) is not None for n in needs) for run in runs):
        return [Cell("all axes", "not recorded", 0, "")]
    found = next((f.where for f in diagnosis.exact if f.where.stage == stage), None)
    if found is None:
        return [Cell(place(a), "exact", 1, "re-executed to rounding") for a in ACTUATORS]
    cells = []
    for name in ACTUATORS:
        hit = found.actuator in (name, "all")
        text = quantity(found.gap, found.unit) if hit else "exact"
        cells.append(Cell(place(name), text, 3 if hit else 1, found.regime if hit else "re-executed to rounding"))
    return cells


def _measured(diagnosis: Diagnosis, stage: str) -> list[Cell]:
    gaps = {g.channel.actuator: g for g in diagnosis.gaps if g.channel.stage == stage}
    names = [n for n in (*ACTUATORS, "tip", "force_sensor") if n in gaps]
    if not names:
        return [Cell("", "not recorded", 0, "")]
    cells = []
    for name in names:
        gap = gaps[name]
        unit = unit_of(gap.channel)
        level = 3 if gap.significant else (2 if gap.power > 0.75 else 1)
        tip = f"gap {quantity(gap.gap, unit)}, floor {quantity(gap.floor, unit)} rms"
        below = f"{quantity(gap.gap, unit)} over {quantity(gap.floor, unit)}" if level == 3 else ""
        cells.append(Cell(place(name), ratio_text(gap.ratio), level, tip, below))
    return cells
