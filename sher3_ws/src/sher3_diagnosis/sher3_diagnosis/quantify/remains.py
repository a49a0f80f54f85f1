"""What a cause leaves of a gap: where the state of its law was not recorded, only what exceeds the law's level."""

from __future__ import annotations

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.quantify.closure import residual_after


def remains(evidence: Evidence, fit: Fit, index: int, channel: Channel) -> dict[int, Array]:
    """Return what a fit leaves of a channel that speaks against one cause, {run: (N, d)} in SI units, on held-out runs.

    Where the cause may hold anything (`Effect.held`), what is beyond its level is left, and nothing below it.
    """
    term, out = fit.terms[index], residual_after(evidence, fit, channel)
    for r, left in out.items():
        if channel not in term.columns[r]:
            continue
        own = fit.loro_of(index)[r]
        level = term.effect.held(evidence.views[r], term.site, term.shape, own)
        if level is None:
            continue
        level = level[evidence.data.residuals[r][channel].ok][:, None]
        whole = left + np.reshape(term.adds(r, channel, own), left.shape) * evidence.floors[r][channel]
        beyond = np.sign(whole) * np.maximum(np.abs(whole) - level, 0.0)
        out[r] = np.where(level > 0.0, beyond, left)
    return out


def excess_of(evidence: Evidence, channel: Channel, left: dict[int, Array]) -> float:
    """Return the loss above the floor of what is left of a channel, {run: (N, d)} in SI units."""
    squares = (float(np.sum((x / evidence.floors[r][channel]) ** 2)) for r, x in left.items())
    return sum(squares) - evidence.samples(channel)
