"""The least size of each plain law that would have made a gap: what the absence of a cause is worth.

A law that nobody found is put where it is not, beside the noise that is there. What the terms that are no causes take
of it does not show.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Term, make_term
from sher3_diagnosis.localise.gaps import PARTS
from sher3_diagnosis.thresholds import FLOOR_SCATTER, POOLED
from sher3_diagnosis.words import lower, place, rounded

TAKEN = 1e-9
"""Share of a law's power below which rounding is what the terms that are no causes leave of it."""
TRIES = 4
"""Times a size is scaled by the power of its law: without a coefficient it is nearly in proportion to the size."""


def would_have_shown(evidence: Evidence, effects: Sequence[Effect], gaps: Collection[Channel]) -> list[str]:
    """Return a sentence for each place without a gap: from which size on each plain law makes one by itself.

    Args:
        evidence: of one part.
        effects: that it may have.
        gaps: its channels with a gap; where a law would show in one of them nothing is said.
    """
    said: dict[str, dict[str, str]] = {}
    silent = set(evidence.channels) - set(gaps)
    for effect in effects:
        for site in (x for kind in effect.places for x in evidence.places.get(kind, ())):
            seen_at = set(effect.channels(site)) & set(evidence.channels)
            if seen_at and seen_at <= silent and (sizes := _least(evidence, effect, site)):
                said.setdefault(site, {})[lower(effect.id)] = " and ".join(sizes)
    return [
        f"{place(site)}: would have shown: {', '.join(f'{law} {size}' for law, size in each.items())}"
        for site, each in said.items()
    ]


def _least(evidence: Evidence, effect: Effect, site: str) -> list[str]:
    """Return the size, for each unit the largest, at which each number of a law alone makes a gap; [] of a rich law."""
    shapes = effect.plain_shapes(evidence.views, site) or (effect.shapes(evidence.views, site) if effect.amount else [])
    if not shapes or not (effect.plain or shapes == [{}]):
        return []
    found: dict[str, tuple[float, str]] = {}
    for name, value, stiff in _sizes(evidence, effect, site, shapes[0]):
        unit = evidence.own_unit(effect.unit(name, site, site in evidence.rotary), site)
        low, high = effect.limits(shapes[0]).get(name, (-np.inf, np.inf))
        if value > (1.0 if unit == "1" else max(abs(low), abs(high))):
            continue  # more than the whole, or than is possible: no size shows
        text = rounded(value, unit) if unit != "1" else f"{100.0 * value:.2g} %"
        weak = -value if stiff else value
        found[unit] = max(found.get(unit, (-np.inf, "")), (weak, f"{'below' if stiff else 'from'} {text}"))
    return [text for _, text in found.values()]


def _sizes(evidence: Evidence, effect: Effect, site: str, shape: Shape) -> Iterator[tuple[str, float, bool]]:
    """Yield a parameter, the value from which on it shows and whether it falls with the law, for each coefficient."""
    term = make_term(evidence.data, effect, site, shape)
    if not any(term.fixed):
        for k in range(term.width):
            power = _power(evidence, term, term.columns, k)
            one = np.eye(term.width)[k] / np.sqrt(power) if power else np.zeros(term.width)
            none, some, twice = (effect.parameters(shape, x * one) for x in (0.0, 1.0, 2.0))
            moved = [n for n, x in some.items() if x != none[n] and np.isfinite(x)]
            yield from [(n, abs(some[n]), abs(twice[n]) < abs(some[n])) for n in moved[:1]]
    elif effect.amount in shape:
        value = shape[effect.amount]
        for _ in range(TRIES):
            term = make_term(evidence.data, effect, site, {**shape, effect.amount: value})
            fixed = [{c: x[:, None] for c, x in found.items()} for found in term.fixed]
            power = _power(evidence, term, fixed, 0)
            if not power:
                return
            value /= np.sqrt(power)
        yield effect.amount, value, False


def _power(evidence: Evidence, term: Term, columns: Sequence[dict[Channel, Array]], index: int) -> float:
    """Return the mean square over its threshold of one column of a term where it shows most; 0 where it never does."""
    rise, most = 1.0 + FLOOR_SCATTER / max(evidence.repeats, 1), 0.0
    for channel in term.channels:
        runs = [r for r, found in enumerate(columns) if channel in found]
        own = np.concatenate([columns[r][channel][:, index] for r in runs])
        beside = [t for t in evidence.nuisance if channel in t.channels]
        left = own - _taken(beside, channel, [(r, len(columns[r][channel])) for r in runs], own) if beside else own
        each = np.mean(left.reshape(-1, len(evidence.floors[runs[0]][channel])) ** 2, axis=0)
        power = max(float(np.mean(each[part])) for part in PARTS[len(each)])
        most = max(most, power / (rise * POOLED[channel.stage]) if power > TAKEN * float(np.mean(own**2)) else 0.0)
    return most


def _taken(beside: Sequence[Term], channel: Channel, runs: Sequence[tuple[int, int]], own: Array) -> Array:
    """Return what terms that every fit carries take of a column (N,)."""
    x = np.hstack([np.concatenate([t.wide(r, channel, n) for r, n in runs]) for t in beside])
    return np.asarray(x @ np.linalg.lstsq(x, own, rcond=None)[0])
