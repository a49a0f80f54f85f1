"""A description drafted from a file, whatever kind of machine its columns speak of."""

from __future__ import annotations

from pathlib import Path

from sher3_machines.intake.draft import Draft, draft
from sher3_machines.intake.runs import longest
from sher3_machines.positioning.draft import draft_test, is_test


def draft_of(path: Path, rate: float | None = None, model: Path | None = None) -> Draft:
    """Draft the joints of an arm where its model is given, a positioning test of a table, else a chain of axes.

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
    return draft_test(path, tables) if rate is None and is_test(tables) else draft(path, rate, tables)
