"""What a report says of tables: rows, not time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.reporter import FLOWS, Output, Reporter

from sher3_static.table import TableEvidence


@dataclass(frozen=True)
class Words:
    """How a kind of table is spoken of.

    Attributes:
        rows: what was recorded, with `{n}` rows of the table `{name}`.
        whole: all rows of the table `{name}`, for a caption.
        row: one of them.
        parts: what is held out in turn, in the plural.
        end: where the closure is read.
        flows: stage -> what goes in and what comes out.
        residual: stage -> what the residual is.
    """

    rows: str
    whole: str
    row: str
    parts: str
    end: str
    flows: Mapping[str, str]
    residual: Mapping[str, str]


class TableReporter(Reporter[TableEvidence]):
    """The part of any table in a report."""

    formulas = False

    def __init__(self, words: Words) -> None:
        self.words, self.flows = words, {**FLOWS, **words.flows}
        self.abscissa, self.held_out, self.end = words.row, words.parts, words.end

    def data(self, parts: Sequence[TableEvidence]) -> str:
        """Return the number of rows of each table."""
        return ", ".join(self.words.rows.format(n=part.table.view.rows, name=part.table.name) for part in parts)

    def run_name(self, evidence: TableEvidence, run: int) -> str:
        """Return what is drawn: every row."""
        return self.words.whole.format(name=evidence.table.name)

    def together(self, evidence: TableEvidence, run: int) -> Sequence[int]:
        """Return all parts: each row is in one of them."""
        return range(len(evidence.excitations))

    def clock(self, evidence: TableEvidence, run: int) -> Array:
        """Return the number of each row, (g,)."""
        return np.arange(evidence.table.view.rows, dtype=float)

    def output(self, evidence: TableEvidence, run: int, channel: Channel) -> Output:
        """Return the name of the residual."""
        return Output(self.words.residual[channel.stage])
