"""The contribution ranking: what each cause adds to the figures of the standard."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array

from sher3_machines.positioning.description import AxisTest
from sher3_machines.positioning.evidence import TableEvidence
from sher3_machines.positioning.iso import Circular, Positioning, circular, positioning

UNITS = {"linear": "um", "rotary": "urad"}


def figures(evidence: TableEvidence, part: Array) -> Positioning | Circular:
    """Return the figures of a test after a part (g,) of its deviations is taken off."""
    rows = evidence.rows
    if isinstance(evidence.test, AxisTest):
        return positioning(rows["target"], rows["deviation"] - part, rows["direction"])
    return circular(rows["angle"], rows["radius"] - part, rows["turning"])


def parts(evidence: TableEvidence, attribution: Attribution) -> list[tuple[str, str, Array]]:
    """Return each cause with its site and what it adds to every row, (g,), m or rad."""
    out = []
    view, fit = evidence.data.views[0], attribution.fit
    for i in attribution.causes:
        term = fit.terms[i]
        columns = term.effect.signature(view, term.site, term.shape).columns[evidence.channel]
        out.append((term.effect.id, term.site, columns[:, 0] @ fit.of(i)))
    return out


def ranking(evidence: TableEvidence, attribution: Attribution) -> list[str]:
    """Return the figures as measured, what they would be without each cause, largest gain first, and without all."""
    found = parts(evidence, attribution)
    unit = UNITS[evidence.test.motion] if isinstance(evidence.test, AxisTest) else "um"
    standard = "ISO 230-2" if isinstance(evidence.test, AxisTest) else "ISO 230-4"
    nothing = np.zeros(len(next(iter(evidence.rows.values()))))
    measured = figures(evidence, nothing)
    lines = [f"{evidence.test.name}: {standard}, {unit}: {measured}"]
    without = sorted(((figures(evidence, part), effect, site) for effect, site, part in found), key=lambda x: x[0][0])
    for rank, (left, effect, site) in enumerate(without, start=1):
        share = (measured[0] - left[0]) / measured[0]
        lines.append(f"{evidence.test.name}: contribution {rank}: {effect} on {site}: {share:.0%}; without it {left}")
    if len(found) > 1:
        lines.append(f"{evidence.test.name}: without all of them {figures(evidence, sum_of(found, nothing))}")
    return lines


def sum_of(found: Sequence[tuple[str, str, Array]], nothing: Array) -> Array:
    """Return what all causes together add to every row, (g,)."""
    return nothing + sum((part for _, _, part in found), nothing)
