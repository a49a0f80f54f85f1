"""Unknown constants of a record: the zero of an encoder, the content of an integral when the record began.

They differ from record to record and are no part of the machine. Every fit carries one for each record, of which all
that is known is that it is no larger than what was recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.fit.fitting import Term, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.tolerance import NUISANCE, SIGMAS

ZERO, INTEGRAL = "zero_of_the_encoders", "start_of_the_integral"
"""Ids of the two constants."""


class ConstantOfRecord(Effect):
    """One constant in each record: columns that every fit carries.

    Attributes:
        records: views of the records, by identity; blocks of one record share theirs.
        size: largest reading of the channel, in its unit: the standard deviation that a constant has beforehand.
    """

    family = NUISANCE
    explanation = "A zero that nobody states differs from record to record."

    def __init__(self, name: str, stage: str, records: Sequence[int], size: float) -> None:
        self.id, self.stage = name, stage  # type: ignore[misc]
        self.records, self.size = records, size

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return a column for each record: `size` in the view's own, zero in the others."""
        columns = np.zeros((len(view.run.grid), 1, len(self.records)))
        if id(view) in self.records:
            columns[:, 0, self.records.index(id(view))] = self.size
        return Signature({Channel(self.stage, site): columns})


def constants(data: Standardised, name: str, channels: Sequence[Channel]) -> tuple[Term, ...]:
    """Return a term for each channel that was recorded, with one constant for each record."""
    return tuple(_constant(data, name, c) for c in channels if any(c in target for target in data.target))


def _constant(data: Standardised, name: str, channel: Channel) -> Term:
    records = list(dict.fromkeys(id(v) for v, x in zip(data.views, data.target, strict=True) if channel in x))
    size = max(float(np.abs(x[channel].values[x[channel].ok]).max()) for x in data.residuals if channel in x)
    effect = ConstantOfRecord(name, channel.stage, records, max(size, np.finfo(float).tiny))
    return replace(make_term(data, effect, channel.actuator, {}), limit=SIGMAS)
