"""What could hide behind the only encoder of an axis: the smallest play and the stiffest spring that would be seen.

Half of the mass, and half of the friction, is put behind a gap or a spring that is not there. What the other causes
cannot take of the force that this would need is added to what they leave; where that would be a gap by the engine's own
rule, and most of it worth a cause, it would have been seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.localise.gaps import gap_of
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.thresholds import WORTH
from sher3_effects import pages
from sher3_effects.page import Hidden
from sher3_effects.registry import ONE_ENCODER
from sher3_effects.view import NominalAxis

from sher3_chain.axes.evidence import AxisEvidence

BEHIND = 0.5
"""Share of mass and friction that is put behind the gap, since its true share is unknown. Set by that argument."""


def one_encoder_note(evidence: AxisEvidence, after: Fit) -> str:
    """Return what one encoder cannot show of this axis, in words."""
    axis = evidence.axis
    if axis.encoder_at == "load":
        if not axis.servo:
            return f"{axis.name}: one encoder, at the load: play before it moves the motor alone and is not looked for"
        return _page_notes(f"{axis.name}: one encoder, at the load: ", evidence, after, {"behind"})
    if axis.servo or axis.free:
        return f"{axis.name}: one encoder and no effort: play and springs behind it are not in the data"
    if evidence.mass <= 0.0 or any(view.run.effort is None for view in evidence.records):
        return f"{axis.name}: one encoder and no force balance: play and springs behind it are not in the data"
    return _page_notes(
        f"{axis.name}: one encoder: with half of the mass behind it ", evidence, after, {"alone", "drive"}
    )


def _page_notes(head: str, evidence: AxisEvidence, after: Fit, facts: set[str]) -> str:
    """Return what the pages say that need to know of a single encoder, where nothing like them was named."""
    axis, named = evidence.axis, {t.effect.id for t in after.terms}
    units, mass = (axis.unit_of_position, axis.unit_of_force), BEHIND * evidence.mass
    nominal = NominalAxis(evidence.mass, axis.viscous, 0.0, 0.0)
    found = [p.on(nominal) for p in pages("servo" if axis.servo else "axis", facts) if ONE_ENCODER & set(p.needs)]
    said = [
        page.least_shown(evidence.records, axis.name, Hidden(mass, axis.encoder_resolution, units, seen))
        for page in found
        if not named & {page.id, *page.indistinct}
        for seen in [partial(shows, evidence, after, page)]
    ]
    return head + " and ".join(said) if said else ""


def shows(evidence: AxisEvidence, after: Fit, page: Effect, shape: Shape) -> bool:
    """Return whether a load behind a gap or a spring would leave a gap that the causes do not take."""
    site = evidence.axis.name
    channel = Channel("motor_mechanics", site)
    left = residual_after(evidence, after, channel)
    if not left:
        return False
    rubs = sum(abs(float(after.of(i)[0])) for i, t in enumerate(after.terms) if t.effect.dry and t.width)
    sizes = BEHIND * np.array([evidence.mass, rubs])
    added = _columns_in(evidence, channel, left, [(page, shape)])
    added = added @ (sizes[: added.shape[1]] if page.signature(evidence.views[0], site, shape).columns else np.ones(1))
    others = [(t.effect, t.shape) for t in after.terms if channel in t.channels and t.width]
    if others:
        taken = _columns_in(evidence, channel, left, others)
        added = added - taken @ np.linalg.lstsq(taken, added, rcond=None)[0]
    ends = np.cumsum([0, *(len(x) for x in left.values())])
    with_it = {r: x + added[a:b, None] for (r, x), a, b in zip(left.items(), ends, ends[1:], strict=False)}
    gap, floors = gap_of(evidence, channel, with_it), {r: evidence.floors[r][channel][0] for r in left}
    power = sum(float(np.sum((added[a:b] / floors[r]) ** 2)) for r, a, b in zip(left, ends, ends[1:], strict=False))
    excess = sum(float(np.sum((x / floors[r]) ** 2)) - len(x) for r, x in with_it.items())
    return gap is not None and gap.significant and power > WORTH * excess


def _columns_in(evidence: AxisEvidence, channel: Channel, runs: Any, pages: Sequence[tuple[Effect, Shape]]) -> Array:
    """Return the columns (N, p) of some pages on the samples that count of some runs."""
    rows, seen = [], dict[int, list[Signature]]()
    for r in runs:
        ok, view = evidence.data.residuals[r][channel].ok, evidence.views[r]
        if id(view) not in seen:  # blocks of one record share its view
            seen[id(view)] = [page.signature(view, channel.actuator, shape) for page, shape in pages]
        found = seen[id(view)]
        parts = [x.columns[channel][ok, 0] if channel in x.columns else x.fixed[channel][ok] for x in found]
        rows.append(np.concatenate(parts, axis=1))
    return np.concatenate(rows)
