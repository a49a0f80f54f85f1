"""The least size of each plain law that would have shown: what a verdict without a gap is worth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.fit.fitting import Term, make_term
from sher3_diagnosis.thresholds import FLOOR_SCATTER, POOLED

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.joint.own_unit import renamed


def least_seen(evidence: AxisEvidence, effects: Sequence[Effect]) -> list[str]:
    """Return in a sentence the size from which each plain law of one number makes a gap by itself; [] without any."""
    said = []
    for effect in (e for e in effects if e.plain):
        for shape in effect.plain_shapes(evidence.views, evidence.axis.name)[:1]:
            term = make_term(evidence.data, effect, evidence.axis.name, shape)
            size = _least(term, evidence.repeats)
            if size is not None:
                name, value = next(iter(effect.parameters(shape, np.array([size])).items()))
                unit = effect.unit(name, term.site, term.site in evidence.rotary)
                unit = renamed(unit, own) if (own := evidence.axis.own_unit) else unit
                said.append(f"{effect.id} from {abs(value):.2g}" + (f" {unit}" if unit != "1" else ""))
    return [f"{evidence.axis.name}: would have shown: {', '.join(said)}"] if said else []


def _least(term: Term, repeats: int) -> float | None:
    """Return the coefficient at which a term alone has the power of a gap; None where it is none, or has more."""
    columns = [(c, x) for run in term.columns for c, x in run.items()]
    power = float(np.mean(np.concatenate([x[:, 0] for _, x in columns]) ** 2)) if columns and term.width == 1 else 0.0
    if not power or any(term.fixed):
        return None
    return float(np.sqrt(POOLED[columns[0][0].stage] * (1.0 + FLOOR_SCATTER / max(repeats, 1)) / power))
