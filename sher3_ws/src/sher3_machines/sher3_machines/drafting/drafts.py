"""A description drafted from a file, whatever kind of machine its columns speak of."""

from __future__ import annotations

from pathlib import Path

from sher3_machines.drafting.draft import draft
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.kinds import kinds
from sher3_machines.intake.runs import longest


def draft_of(path: Path, rate: float | None = None, model: Path | None = None) -> Draft:
    """Draft what the first kind that knows the file makes of it, else a chain of axes.

    Args:
        path: of the data.
        rate: samples per second, Hz, where no time was recorded.
        model: URDF or MJCF of the arm whose joints were recorded.

    Raises:
        MachineError: the file cannot be read, or no column looks like a time or a position.
    """
    tables = longest(path)
    drafts = (kind.draft(path, tables, rate, model) for kind in kinds().values())
    return next((found for found in drafts if found is not None), None) or draft(path, rate, tables)
