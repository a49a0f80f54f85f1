"""Runs that were never made: what a fit foretells of them on a machine whose laws are bent, and what that does to odds.

Where its law was not yet looked at, nobody knows how a machine departs from its page. Labelled robots do so by a share
of the law's power that differs from robot to robot; so the law is bent by each such share in turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.finding import Judged
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.evidence.bent import added, stray_share
from sher3_diagnosis.judge.level import LEVELS
from sher3_diagnosis.judge.probabilities import judged

LABELLED = LEVELS[:4]
"""Shares of a law's power by which it may be bent: the levels that labelled robots were drawn with."""
OF_TODAY = ("law", "anything")
"""Evidence that further runs would change in a way that a drawn bend does not tell."""


Bend = Callable[[Channel, float], dict[int, Array]]
"""Factors on a law at a channel per run, (N,), for a share of its power by which it is bent."""


def predicted(
    found: Fit, terms: Sequence[Term], more: Standardised, level: float, bend: Bend | None = None
) -> list[dict[Channel, Array]]:
    """Return what the terms of a fit add to further runs, per run and channel (N,), over the floor.

    The law of the last of them is bent by a share `level` of its power, with `bend`; default `bend_of(more)`.
    """
    out = [{c: np.zeros(len(y)) for c, y in seen.items()} for seen in more.target]
    bend = bend or bend_of(more)
    bends = {c: bend(c, level) for c in terms[-1].channels} if level else {}
    for i, term in enumerate(terms):
        for r, total in enumerate(out):
            for c in total:
                own = term.adds(r, c, found.of(i))
                total[c] = total[c] + (own * bends[c][r] if term is terms[-1] and c in bends else own)
    return out


def bend_of(more: Standardised) -> Bend:
    """Return one sine of the place's inputs in all runs for each component, the same for whichever law it bends."""

    @cache
    def inputs_at(actuator: str) -> list[Array]:
        inputs = [view.inputs(actuator) for view in more.views]
        together = np.concatenate(inputs)
        middle, scale = together.mean(axis=0), np.maximum(together.std(axis=0), np.finfo(float).tiny)
        return [(x - middle) / scale for x in inputs]

    @cache
    def bend(channel: Channel, level: float) -> dict[int, Array]:
        inputs = inputs_at(channel.actuator)
        seen = {r: found[channel] for r, found in enumerate(more.residuals) if channel in found}
        width = next(iter(seen.values())).values.shape[1]
        rng = np.random.default_rng(round(1.0 / level))
        rates = rng.standard_normal((inputs[0].shape[1], width)) * math.pi / math.sqrt(inputs[0].shape[1])
        phase = rng.uniform(0.0, 2.0 * math.pi, width)
        size = math.sqrt(2.0 * level)
        return {r: (1.0 + size * np.sin(inputs[r][x.ok] @ rates + phase)).ravel() for r, x in seen.items()}

    return bend


def with_bend(j: Judged, before: Fit, after: Fit, data: Standardised, worth: float) -> float:
    """Return the probability of the library after further runs, on which the law of a cause is bent.

    Args:
        j: the cause as it is judged today.
        before: the fit to the recorded runs; the cause is its last term.
        after: the fit to recorded and further runs.
        data: these runs, of which the further ones have no noise.
        worth: loss that the cause takes off all runs.
    """
    channel, recorded = j.item.channel, len(before.loro_coefficients)
    new = {
        r: data.target[r][channel].reshape(-1, data.residuals[r][channel].values.shape[1])
        for r in range(recorded, len(data.target))
        if channel in data.target[r]
    }
    worth = max(worth, 1.0)
    stray = bend = max(0.0, after.total - before.total) / worth
    if new:
        parts = [added(after, i, channel, new) for i in range(len(after.terms))]
        rest = np.concatenate(list(new.values())) - sum(parts)
        stray *= stray_share(np.sqrt(rest**2 + 1.0), parts[-1])  # beside the noise that the floor has
    known = {name: x for name, x in j.item.numbers.items() if name not in OF_TODAY}
    bent = {"left": known["left"] + bend, "stray": known["stray"] + stray}
    if "spread" in known:
        steady = sum(x for (r, _), x in after.loss.items() if r < recorded) - before.total
        bent["spread"] = known["spread"] + max(0.0, steady) / worth
    anew = judged(replace(j.item, numbers=known | bent), in_force(), j.closure)
    return min(j.library, anew.library)
