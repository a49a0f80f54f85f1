"""The kind `load_cell`: readings of one axis under known forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.words import lower
from sher3_effects.table_view import CellView
from sher3_machines.thresholds import BLOCKS

from sher3_static.cell.description import CellDescription
from sher3_static.cell.draft import draft_cell
from sher3_static.cell.reading import LEAST_ROWS, MORE_ROWS, read_cell, scatter, unloading
from sher3_static.kind import TableKind
from sher3_static.readings import Readings, enough, joined, warmed
from sher3_static.reporter import Words
from sher3_static.table import Table, TableEvidence

READING = Channel("sensing", "load_cell")
"""The one channel of a cell."""
RESOLVED = 1e-6
"""Smallest floor as a share of the range: readings that agree to the last digit are limited by their rounding."""


class CellKind(TableKind[CellDescription]):
    """Load cells: what a cell read under known forces."""

    name, description = "load_cell", CellDescription
    reader = staticmethod(read_cell)
    drafter = staticmethod(draft_cell)
    stored = ("applied", "reading", "temperature")
    written_for = ("cell",)
    words = Words(
        rows="{n} readings under known forces",
        whole="All readings",
        row="reading",
        parts="readings",
        end="of the reading",
        flows={"sensing": "force → reading"},
        residual={"sensing": "reading − force"},
    )

    def tables(self, known: CellDescription, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return all readings as one table; every eighth is held out in turn."""
        rows = joined(runs)
        side = np.concatenate([unloading(run["applied"]) for run in runs])
        view = CellView(warmed(runs), rows["applied"], side)
        enough(f"{known.name}: too few readings", view.rows, LEAST_ROWS, MORE_ROWS)
        least = RESOLVED * float(np.ptp(rows["applied"]))
        floor = known.noise or max(scatter(view, rows["reading"], rows["run"]), least)
        table = Table(
            name=known.name,
            channel=READING,
            view=view,
            residual=(rows["reading"] - rows["applied"])[:, None],
            floor=np.array([floor]),
            spread=np.std(rows["applied"], keepdims=True),
            part=np.arange(view.rows) % BLOCKS,
            run=rows["run"],
            unit=known.unit,
            pages=self.library(),
            places={"load_cell": (READING.actuator,)},
            rotary=frozenset({READING.actuator} if known.measures == "torque" else ()),
            zeros=np.ones((view.rows, 1, 1)),
        )
        return [table]

    def notes_on(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return what data sheets of cells state: errors in shares of the largest force."""
        table = finding.evidence.table
        whole = float(np.abs(table.view.applied).max())  # type: ignore[attr-defined]
        notes = [f"readings scatter by {100.0 * table.floor[0] / whole:.2g}% of the largest force"]
        for cause in finding.causes:
            forces = [p.value for p in cause.parameters.values() if p.unit == table.unit]
            notes += [f"{lower(cause.effect)} of {100.0 * value / whole:.2g}% of the largest force" for value in forces]
        return notes


KIND = CellKind()
