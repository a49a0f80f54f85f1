"""Evidence of a chain of joints, in blocks that take the place of runs when nothing was repeated."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Floors, Residual, Residuals
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.standardised import Standardised
from sher3_machines.thresholds import BLOCKS

from sher3_chain.joint.record import AxesRun
from sher3_chain.thresholds import MIN_BLOCK


@dataclass(frozen=True, kw_only=True)
class ChainEvidence(Evidence):
    """The engine's evidence for a chain; a block of a record is a run.

    Attributes:
        runs: records as imported.
        records: views, one for each record; blocks of one record share theirs.
    """

    runs: Sequence[AxesRun]
    records: Sequence[Any]

    def views_of(self, runs: Collection[str]) -> frozenset[int]:
        """Return the identities of the views of some runs, by their names."""
        return frozenset(id(v) for v, run in zip(self.records, self.runs, strict=True) if run.name in runs)

    def record_of(self, block: int) -> int:
        """Return the record that a block belongs to."""
        return self.records.index(self.data.views[block])

    def foreseen(self, views: Sequence[Any], residuals: Sequence[Residuals]) -> Standardised:
        """Return runs that were never made, in blocks, with the floor of every channel: its median over the records.

        Args:
            views: of the runs, one for each record.
            residuals: of each, of which the samples that count are looked at.
        """
        floor = {c: np.median([f[c] for f in self.floors if c in f], axis=0) for c in self.channels}
        found = [{c: x for c, x in seen.items() if c in floor} for seen in residuals]
        return in_blocks(views, found, [floor] * len(views))


def in_blocks(records: Sequence[Any], found: Sequence[Residuals], floors: Sequence[Floors]) -> Standardised:
    """Return the residuals of all records cut into about eight blocks in all.

    Args:
        records: views of them.
        found: residuals of each.
        floors: of each.
    """
    per_record = -(-BLOCKS // len(records))
    blocks = [(r, block) for r, x in enumerate(found) for block in blocks_of(x, per_record)]
    return Standardised([records[r] for r, _ in blocks], [b for _, b in blocks], [floors[r] for r, _ in blocks])


def blocks_of(found: Residuals, number: int) -> list[Residuals]:
    """Cut the residuals of a record into at most `number` blocks with about equal numbers of samples that count."""
    if not found:
        return []
    counts = max(found.values(), key=lambda x: int(x.ok.sum())).ok
    total = int(counts.sum())
    number = max(1, min(number, total // MIN_BLOCK))
    block = np.minimum(np.cumsum(counts) * number // (total + 1), number - 1)
    return [{c: Residual(x.values, x.ok & (block == k)) for c, x in found.items()} for k in range(number)]
