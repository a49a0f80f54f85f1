"""What a kind of table gives: what a user writes, how its columns are read, and the tables they make."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Policy
from sher3_diagnosis.verdict import Interval
from sher3_effects import pages
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_static.machine import StaticTest
from sher3_static.readings import Readings
from sher3_static.reporter import Words
from sher3_static.table import Table, TableEvidence

D = TypeVar("D", bound=Description)

MOST = 6
"""Causes named at most: a table may have one of each page."""


class TableKind(Kind[D, Readings]):
    """A kind of table; a case stores the columns of its readings.

    Attributes:
        stored: columns that a case of this kind has at least.
        written_for: words of `Effect.kinds` whose pages it may have.
        words: how a report speaks of it.
        policy: what the judgement may lean on.
    """

    stored: tuple[str, ...] = ()
    written_for: tuple[str, ...]
    words: Words
    policy = Policy(down_to_floor=True)

    @abstractmethod
    def tables(self, known: Any, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return the tables of all runs; raises MachineError where no answer could rest on them."""

    def known(self, description: D) -> Any:
        """Return what is known of the machine; default its description."""
        return description

    def library(self) -> Sequence[Effect]:
        """Return the pages written for this kind."""
        return [page for word in self.written_for for page in pages(word)]

    def attribute(self, evidence: TableEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Search for up to six causes: a table may have one of each page."""
        return attribute(candidates, left_over, say, MOST)

    def remarks(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return notes on one table; default none."""
        return []

    def end_to_end(self, findings: Sequence[Finding[TableEvidence]]) -> Interval | None:
        """Return the closure at the end of the chain; default none."""
        return None

    def machine(self, description: D) -> StaticTest:
        """Return the tables as a machine; raises MachineError where a file of the description cannot be used."""
        return StaticTest(self, self.known(description))

    def pack(self, run: Readings) -> Mapping[str, Array]:
        """Return the columns."""
        return run.columns

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> Readings:
        """Return the readings that a case stores; raises KeyError where a column is missing."""
        return Readings(name, {**{column: arrays[column] for column in self.stored}, **arrays}, notes)
