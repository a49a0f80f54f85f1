"""Machines other than SHER: a short description and a data file become a case that the same engine diagnoses.

`description` says what a machine is, `case` turns its records into a case folder, `diagnose` answers with the
engine's verdict.
"""

from sher3_gap.machines.case import is_machine_case as is_machine_case
from sher3_gap.machines.errors import MachineError as MachineError
