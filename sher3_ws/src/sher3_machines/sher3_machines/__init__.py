"""Machines other than SHER: a short description and data files become a case that the same engine diagnoses.

A kind of machine is a `Kind` that a package names by an entry point; `open_case(path)` returns the `Machine` of a case
and its runs.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sher3_machines.errors import MachineError as MachineError
    from sher3_machines.intake.case import described as described
    from sher3_machines.intake.case import import_case as import_case
    from sher3_machines.intake.case import is_machine_case as is_machine_case
    from sher3_machines.intake.case import open_case as open_case
    from sher3_machines.intake.kinds import kinds as kinds
    from sher3_machines.intake.kinds import load_description as load_description

_ROOMS = {
    "MachineError": "errors",
    "described": "intake.case",
    "import_case": "intake.case",
    "is_machine_case": "intake.case",
    "kinds": "intake.kinds",
    "load_description": "intake.kinds",
    "open_case": "intake.case",
}


def __getattr__(name: str) -> object:
    """Import a name at its first use: a small name costs what it needs."""
    if name in _ROOMS:
        return getattr(import_module(f"{__name__}.{_ROOMS[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
