"""The contribution ranking: what each cause adds to the figures of the standard."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array, Mask

from sher3_static.positioning.description import AxisTest
from sher3_static.positioning.evidence import TableEvidence
from sher3_static.positioning.iso import Circular, Positioning, circular, positioning

UNITS = {"linear": "um", "rotary": "urad"}


POLE = 1.5
"""Points on either side of a pole at which nobody knows whether the axis had turned round when the point was taken."""


def figures(evidence: TableEvidence, part: Array) -> Positioning | Circular:
    """Return the figures of a test after a part (g,) of its deviations is taken off.

    A step at a pole of a circle that is taken off a point too early or too late would be the largest deviation by
    itself, so that these points are left out then.
    """
    rows = evidence.rows
    if isinstance(evidence.test, AxisTest):
        return positioning(rows["target"], rows["deviation"] - part, rows["direction"])
    kept = away_from_poles(rows["angle"]) if part.any() else np.ones(len(part), dtype=bool)
    return circular(rows["angle"][kept], (rows["radius"] - part)[kept], rows["turning"][kept])


def away_from_poles(angle: Array) -> Mask:
    """Return (g,) False at the points of a circle next to a pole, where one of its axes turns round."""
    step = float(np.median(np.abs(np.angle(np.exp(1j * np.diff(angle))))))
    quarter = 0.5 * np.pi
    return np.asarray(np.abs(angle - quarter * np.round(angle / quarter)) > POLE * step)


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
