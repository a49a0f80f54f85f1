"""A table of readings and the engine's evidence of it: residuals, floors, what is held out, what every fit carries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.tolerance import NUISANCE
from sher3_diagnosis.thresholds import EATEN
from sher3_diagnosis.words import quantity
from sher3_effects.table_view import Still

from sher3_static.readings import Labels

PARTS = 4
"""Parts that are held out in turn where each part of the table would be a whole run: its zero is then not known."""
APART = 3.0
"""Floors by which the zeros of two runs must differ to be told: a floor is the standard deviation of one reading."""


@dataclass(frozen=True, kw_only=True)
class Table:
    """Readings of g rows and d components under known conditions.

    Attributes:
        name: of the table.
        channel: its one channel.
        view: what the effects ask of it.
        residual: (g, d) reading less what it should be.
        floor: (d,) standard deviation of a reading.
        spread: (d,) standard deviation of what the readings should follow.
        part: (g,) label of the rows that are held out together.
        run: (g,) number of the run of each row.
        unit: SI unit of the first components.
        pages: effects it may have.
        places: kind of place -> the sites that are one.
        rotary: sites that turn.
        free: (g, d, p) columns of numbers that nobody knows and that are no cause: every fit carries them.
        zeros: (g, d, q) columns of those that may differ from run to run.
        known: what the kind's own remarks read.
    """

    name: str
    channel: Channel
    view: Still
    residual: Array
    floor: Array
    spread: Array
    part: Labels
    run: Labels
    unit: str
    pages: Sequence[Effect]
    places: Mapping[str, Sequence[str]]
    rotary: frozenset[str] = frozenset()
    free: Array | None = None
    zeros: Array | None = None
    known: Any = None


@dataclass(frozen=True, kw_only=True)
class TableEvidence(Evidence):
    """The engine's evidence of one table.

    Attributes:
        table: as the kind gives it.
    """

    table: Table


class Free(Effect):
    """Numbers of a set-up that nobody knows: columns that every fit carries, so that no effect is blamed for them."""

    id, family = "set_up", NUISANCE
    explanation = "Nobody says where the instrument has its zero, nor where it was set up."

    def __init__(self, channel: Channel, columns: Array) -> None:
        self.stage, self.channel, self.columns = channel.stage, channel, columns  # type: ignore[misc]

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the channel of the table."""
        return (self.channel,)

    def signature(self, view: Still, site: str, shape: Shape) -> Signature:
        """Return the columns."""
        return Signature({self.channel: self.columns})


def evidence_of(table: Table) -> TableEvidence:
    """Return the residuals of a table, each part held out in turn."""
    labels = held_out(table)
    parts = [labels == k for k in np.unique(labels)]
    data = Standardised(
        [table.view] * len(parts),
        [{table.channel: Residual(table.residual, part)} for part in parts],
        [{table.channel: table.floor}] * len(parts),
    )
    columns = [x for x in (table.free, between_runs(table)) if x is not None and x.shape[2]]
    free = Free(table.channel, np.concatenate(columns, axis=2)) if columns else None
    return TableEvidence(
        excitations=[table.view.excitation] * len(parts),
        data=data,
        units={table.channel: table.unit},
        places=table.places,
        rotary=table.rotary,
        nuisance=(make_term(data, free, table.channel.actuator, {}),) if free else (),
        table=table,
    )


def held_out(table: Table) -> Labels:
    """Return the label (g,) of the rows that are held out together: never a whole run whose zero is free."""
    runs = np.unique(table.run)
    if table.zeros is None or len(runs) == 1 or all(len(np.unique(table.part[table.run == k])) > 1 for k in runs):
        return table.part
    return np.arange(len(table.run)) % PARTS


def between_runs(table: Table) -> Array | None:
    """Return columns (g, d, q (R - 1)) by which the zeros of R runs differ, without a part that all have in common."""
    runs = np.unique(table.run)
    if table.zeros is None or len(runs) == 1:
        return None
    own = [(table.run == k) - np.mean(table.run == k) for k in runs[1:]]
    return np.concatenate([table.zeros * x[:, None, None] for x in own], axis=2)


def zeros_in_words(evidence: TableEvidence, fit: Fit) -> list[str]:
    """Return a note where the zeros of the runs differ by more than the readings scatter."""
    table, columns = evidence.table, between_runs(evidence.table)
    if columns is None:
        return []
    known = 0 if table.free is None else table.free.shape[2]
    part = columns @ fit.of(0)[known:]
    mean = np.array([part[table.run == k].mean(axis=0) for k in np.unique(table.run)])
    apart = np.ptp(mean, axis=0)
    worst = int(np.argmax(apart / table.floor))
    if apart[worst] < APART * table.floor[worst]:
        return []
    name, by = evidence.component(table.channel, worst), quantity(apart[worst], evidence.unit(table.channel, worst))
    which = f" of {name}" if name else ""
    return [f"{table.name}: zeros{which} differ by {by} from run to run: free in each, and no cause"]


def eaten(table: Table) -> str:
    """Return in words that the scatter of the readings hides what is looked for; nothing where it does not.

    One component that tells is enough.
    """
    share = float(np.min(table.floor / np.maximum(table.spread, np.finfo(float).tiny)))
    text = f"cannot be judged: readings of {table.name} scatter by {share:.2g} of what they should follow, and a cause"
    return f"{text} would hide in it; a wider range, more repeats or a better reference would tell" * (share > EATEN)
