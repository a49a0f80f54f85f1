"""A description drafted from a file, whatever kind of machine its columns speak of."""

from __future__ import annotations

from pathlib import Path

from sher3_machines.intake.draft import Draft, draft
from sher3_machines.intake.kinds import kinds
from sher3_machines.intake.runs import longest


def draft_of(path: Path, rate: float | None = None, model: Path | None = None) -> Draft:
    """Draft the joints of an arm where its model is given, a table as the kind that knows its columns, else axes.

    Args:
        path: of the data.
        rate: samples per second, Hz, where no time was recorded.
        model: URDF or MJCF of the arm whose joints were recorded.

    Raises:
        MachineError: the file cannot be read, or no column looks like a time or a position.
    """
    if model is not None:
        from sher3_machines.manipulator.draft import draft_arm  # its rigid bodies take a second to import

        return draft_arm(path, model, rate)
    tables = longest(path)
    told = (kind.draft(path, tables) for kind in kinds().values()) if rate is None else ()
    return next((found for found in told if found is not None), None) or draft(path, rate, tables)
