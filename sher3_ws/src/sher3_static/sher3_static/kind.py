"""A kind of table: what a user writes, how its columns are read, the tables they make, and the machine of them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from pathlib import Path
from typing import Any, Self, TypeVar

from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Machine, Policy
from sher3_effects import pages
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kind import Draft, Kind
from sher3_machines.intake.tables import Tables

from sher3_static.readings import Readings, whole_rows
from sher3_static.reporter import TableReporter, Words
from sher3_static.table import Table, TableEvidence, eaten, evidence_of, zeros_in_words

D = TypeVar("D", bound=Description)


class TableKind(Kind[D, Readings], Machine[Readings, TableEvidence]):
    """A kind of table, and the machine whose tables they are, each judged by itself; a case stores the columns.

    Attributes:
        reader: checks the columns of a data file, by name, tables and description, and brings them to SI units.
        drafter: drafts a description of a file, by path and tables; None of a file that is no such table.
        stored: columns that a case of this kind has at least.
        written_for: words of `Effect.kinds` whose pages it may have.
        words: how a report speaks of it.
        search: how causes are looked for: up to six, since a table may have one of each page.
        known: what is known of the machine; None of the kind by itself.
    """

    reader: Callable[..., Readings]
    drafter: Callable[[Path, Tables], Draft | None] | None = None
    stored: tuple[str, ...] = ()
    written_for: tuple[str, ...]
    words: Words
    policy = Policy(own_level=True, absences=True)
    search = SearchPlan(causes=6, down_to_floor=True)
    known: Any = None

    def read(self, name: str, tables: Tables, description: D) -> Readings:
        """Check a data file; raises MachineError."""
        return self.reader(name, tables, description)

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft a table, which has neither a clock nor a model of an arm."""
        return self.drafter(path, tables) if self.drafter and rate is None and model is None else None

    @abstractmethod
    def tables(self, known: Any, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return the tables of all runs; raises MachineError where no answer could rest on them."""

    def known_by(self, description: D) -> Any:
        """Return what is known of the machine; default its description."""
        return description

    def machine(self, description: D) -> Self:
        """Return the machine of a description; raises MachineError where a file of it cannot be used."""
        return self.knowing(self.known_by(description))

    def knowing(self, known: Any) -> Self:
        """Return the machine of which something is known."""
        machine = copy(self)
        machine.known = known
        return machine

    def parts(self, name: str, tables: Tables, description: D, records: int = 1) -> tuple[dict[str, Tables], str]:
        """Return a file without the rows that lack a number, and a note on them: each row stands by itself."""
        whole, note = whole_rows(name, tables, description)
        return {name: whole}, note

    def pack(self, run: Readings) -> Mapping[str, Array]:
        """Return the columns by name, a row (n, ...) for each reading."""
        return run.columns

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> Readings:
        """Return the readings that a case stores; raises KeyError where a column is missing."""
        return Readings(name, {**{column: arrays[column] for column in self.stored}, **arrays}, notes)

    def library(self) -> Sequence[Effect]:
        """Return the pages written for this kind."""
        return [page for word in self.written_for for page in pages(word)]

    def effects(self, evidence: TableEvidence) -> Sequence[Effect]:
        """Return the pages of one table."""
        return evidence.table.pages

    def audit(self, runs: Sequence[Readings]) -> list[str]:
        """Return what was done to the data."""
        return [note for run in runs for note in run.notes]

    def gather(self, runs: Sequence[Readings]) -> Sequence[TableEvidence]:
        """Return every table as a part; raises MachineError where nothing tells what repeats."""
        return [evidence_of(table) for table in self.tables(self.known, runs)]

    def plan(self, evidence: TableEvidence) -> SearchPlan:
        """Return how causes are looked for."""
        return self.search

    def notes_on(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return notes of this kind on one table; default none."""
        return []

    def remarks(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return what the kind and the pages of the causes say, and how far the zeros of runs are apart."""
        zeros = zeros_in_words(finding.evidence, finding.attribution.fit)
        return [*self.notes_on(finding), *causes_in_words(finding), *zeros]

    def unjudgeable(self, finding: Finding[TableEvidence]) -> dict[Channel, str]:
        """Say where the scatter of the readings hides whatever is looked for."""
        table = finding.evidence.table
        why = "" if finding.significant else eaten(table)
        return {table.channel: why} if why else {}

    def reporter(self) -> TableReporter:
        """Return the part of this kind in a report."""
        return TableReporter(self.words)


def causes_in_words(finding: Finding[TableEvidence]) -> list[str]:
    """Return what the pages of the causes say of their parameters on this machine."""
    view = finding.evidence.table.view
    sentences = [t.effect.in_words(view, t.effect.parameters(t.shape, found)) for t, found in finding.attribution.named]
    return [note for note in sentences if note]
