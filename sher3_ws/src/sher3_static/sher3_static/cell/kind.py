"""The kind `load_cell`: readings under known forces in a case folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sher3_diagnosis.channel import Array
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_static.cell.description import CellDescription
from sher3_static.cell.machine import LoadCell
from sher3_static.cell.record import CellRun, cell_run


class CellKind(Kind[CellDescription, CellRun]):
    """Load cells; a case stores `applied`, `reading` and `temperature`."""

    name = "load_cell"
    description = CellDescription

    def read(self, name: str, tables: Tables, description: CellDescription) -> CellRun:
        """Check a data file; raises MachineError."""
        return cell_run(name, tables, description)

    def pack(self, run: CellRun) -> Mapping[str, Array]:
        """Return forces, readings and temperatures."""
        return {"applied": run.applied, "reading": run.reading, "temperature": run.temperature}

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> CellRun:
        """Return the record that a case stores; raises KeyError where an array is missing."""
        return CellRun(name, arrays["applied"], arrays["reading"], arrays["temperature"], notes)

    def machine(self, description: CellDescription) -> LoadCell:
        """Return the cell."""
        return LoadCell(description)


KIND = CellKind()
