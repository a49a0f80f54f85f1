"""The kind `positioning`: tests of axes (ISO 230-2) and circles of two axes (ISO 230-4)."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.finding import Finding

from sher3_static.kind import TableKind
from sher3_static.positioning.axis import axis_table
from sher3_static.positioning.circle import circle_table
from sher3_static.positioning.description import PositioningDescription
from sher3_static.positioning.draft import draft_test
from sher3_static.positioning.ranking import ranking
from sher3_static.positioning.reading import read_tests
from sher3_static.readings import Readings
from sher3_static.reporter import Words
from sher3_static.table import Table, TableEvidence


class PositioningKind(TableKind[PositioningDescription]):
    """Axes and planes of a machine tool or stage, each a table of its own."""

    name, description = "positioning", PositioningDescription
    reader = staticmethod(read_tests)
    drafter = staticmethod(draft_test)
    written_for = ("table", "circle")
    words = Words(
        rows="{name}: {n} rows",
        whole="All rows of {name}",
        row="row",
        parts="cycles",
        end="at the reference",
        flows={"transmission": "target → position", "mechanism": "circle → radius"},
        residual={"transmission": "reading − target", "mechanism": "radius − nominal"},
    )

    def tables(self, known: PositioningDescription, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return every test as a table; raises MachineError where nothing tells what repeats."""
        axes = [axis_table(test, [within(run, f"axes/{test.name}/") for run in runs]) for test in known.axes]
        circles = [circle_table(test, [within(run, f"planes/{test.name}/") for run in runs]) for test in known.planes]
        return [*axes, *circles]

    def notes_on(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return the contribution ranking."""
        return ranking(finding.evidence.table, finding.attribution)


def within(run: Readings, test: str) -> Readings:
    """Return the columns of one test of a file; raises KeyError for a case that has none."""
    columns = {name.removeprefix(test): x for name, x in run.columns.items() if name.startswith(test)}
    if not columns:
        raise KeyError(test)
    return Readings(run.name, columns)


KIND = PositioningKind()
