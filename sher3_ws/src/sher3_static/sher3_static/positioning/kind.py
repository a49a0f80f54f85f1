"""The kind `positioning`: tests without a clock in a case folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from sher3_diagnosis.channel import Array
from sher3_machines.intake.draft import Draft
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_static.positioning.description import PositioningDescription
from sher3_static.positioning.draft import draft_test, is_test
from sher3_static.positioning.machine import Positioning
from sher3_static.positioning.record import Tests, read_tests


class PositioningKind(Kind[PositioningDescription, Tests]):
    """Positioning tests; a case stores `axes/NAME/COLUMN` and `planes/NAME/COLUMN`."""

    name = "positioning"
    description = PositioningDescription

    def read(self, name: str, tables: Tables, description: PositioningDescription) -> Tests:
        """Check a data file; raises MachineError."""
        return read_tests(name, tables, description)

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft a test of a table without a clock that has targets and readings; None without them."""
        return draft_test(path, tables) if rate is None and model is None and is_test(tables) else None

    def pack(self, run: Tests) -> Mapping[str, Array]:
        """Return every column."""
        groups = {"axes": run.axes, "planes": run.planes}
        return {f"{g}/{n}/{c}": x for g, tests in groups.items() for n, rows in tests.items() for c, x in rows.items()}

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> Tests:
        """Return the tests that a case stores; raises KeyError for an array of another case."""
        groups: dict[str, dict[str, dict[str, Array]]] = {"axes": {}, "planes": {}}
        for key, x in arrays.items():
            group, test, column = key.split("/") if key.count("/") == 2 else ("", "", "")
            groups[group].setdefault(test, {})[column] = x
        return Tests(name, groups["axes"], groups["planes"], notes)

    def machine(self, description: PositioningDescription) -> Positioning:
        """Return the tests as a machine."""
        return Positioning(description)


KIND = PositioningKind()
