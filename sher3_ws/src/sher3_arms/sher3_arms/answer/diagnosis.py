"""The diagnosis as a user calls it: import the record with a description, open the case, diagnose."""

from __future__ import annotations

from pathlib import Path

from sher3_diagnosis import Verdict, diagnose
from sher3_machines import import_case, open_case

from sher3_arms.files import CASE, DESCRIPTION, RECORD


def answer(folder: Path) -> Verdict:
    """Import and diagnose a sealed case; raises MachineError where it cannot be read."""
    import_case([folder / RECORD], folder / DESCRIPTION, folder / CASE)
    machine, runs = open_case(folder / CASE)
    return diagnose(machine, runs).verdict
