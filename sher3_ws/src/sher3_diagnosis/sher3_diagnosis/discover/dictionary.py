"""Candidate features: which laws of which quantities, alone and in products, a formula may be made of.

A group is taken or left as a whole: a feature alone, or the sine and cosine of one period. Scales of the shapes come
from how far the quantities range; they are starting values that the search refines.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations_with_replacement

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.discover.feature import Factor, Feature, Quantities

Group = tuple[Feature, ...]
"""Features that enter a formula together."""

REACHES = (1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)
"""Displacements of `sliding` and widths of `play`, shares of the range of the position."""
SPEEDS = (0.05, 0.15, 0.4)
"""Scales of `fading` and thresholds of `beyond`, shares of the largest value."""
CENTRES, WIDTHS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9), (0.04, 0.12)
"""Places (quantiles) and widths (shares of the range) of humps."""
TIMES = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Time constants of lags, s."""
FREQUENCIES, DAMPING = (4.0, 5.4, 7.3, 9.8, 13.0, 18.0, 24.0, 33.0, 44.0), 0.15
"""Of what swings, Hz; damped well, so that frequencies a third apart leave no gap. The search sharpens both."""
PACES = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Steepest changes of what follows a command slowly, shares of the command's own steepest one."""
DECAYS = (0.2, 0.6)
"""Time constants of what decays in a run, shares of its length."""
DIRECTION = 1e-3
"""Displacement after which a direction is told, share of the range of the position."""


def dictionary(runs: Sequence[Quantities], unit: str, step: float) -> list[Group]:
    """Return the candidate groups for the quantities of all runs.

    Args:
        runs: quantities of each.
        unit: of the gap.
        step: time between two samples of a record, s.
    """
    spans = {name: _span([r[name].values for r in runs]) for name in runs[0]}
    alive = {name: q for name, q in runs[0].items() if spans[name][1] > spans[name][0]}
    found: dict[Group, None] = {(Feature(),): None}
    commands = {name: [r[name].values for r in runs] for name, q in alive.items() if q.kind == "command"}
    for group in (*_alone(alive, spans, unit), *_slow(commands, step), *_products(alive, spans)):
        found.setdefault(group)
    return list(found)


def _span(parts: Sequence[Array]) -> tuple[float, float, Array]:
    values = np.concatenate([p[::5] for p in parts])
    low, high = np.percentile(values, [0.5, 99.5])
    return float(low), float(high), np.quantile(values, CENTRES)


Spans = Mapping[str, tuple[float, float, Array]]


def _alone(quantities: Quantities, spans: Spans, unit: str) -> Iterator[Group]:
    for name, q in quantities.items():
        low, high, _ = spans[name]
        most, width = max(abs(low), abs(high)), high - low
        laws = ["itself", "square"]
        laws += ["size", "signed_square", "rising", "rising_square", "falling_square"] if low * high < 0 else []
        yield from ((Feature((Factor(law, name),)),) for law in laws)
        if q.kind == "place":
            yield from ((Feature((Factor("sliding", name, (s * width,)),)),) for s in REACHES)
            if q.own and q.unit == unit:  # a lost motion; of a force the direction is the plainer law
                yield from ((Feature((Factor("play", name, (s * width,)),)),) for s in REACHES)
            if q.own:
                yield from (_one(f) for f in _humps(name, spans))
        if q.kind in ("speed", "force", "command") and q.own:
            yield from (_one(Factor("beyond", name, (s * most,))) for s in SPEEDS)
        if q.own and q.kind in ("force", "speed", "place", "state", "command"):
            yield from (_one(Factor("late", name, (t,))) for t in TIMES)
        if q.own and q.kind in ("force", "place", "command"):
            yield _one(Factor("rate", name, (TIMES[0],)))
        if q.own and (q.kind == "force" or q.unit.endswith("/s^2")):
            yield from (_one(Factor("ringing", name, (f, DAMPING))) for f in FREQUENCIES)
        if q.kind == "clock":
            yield from (_one(Factor("decaying", name, (s * most,))) for s in DECAYS)


def _slow(commands: Mapping[str, Sequence[Array]], step: float) -> Iterator[Group]:
    """Yield what follows a command no faster than a share of its steepest change."""
    for name, parts in commands.items():
        steepest = max(float(np.abs(np.diff(x)).max()) for x in parts) / step
        yield from (_one(Factor("slow", name, (s * steepest,))) for s in PACES)


def _products(quantities: Quantities, spans: Spans) -> Iterator[Group]:
    own = {n: q for n, q in quantities.items() if q.own}
    places = [n for n, q in own.items() if q.kind == "place"]
    carriers = [Factor("itself", n) for n, q in own.items() if q.kind != "clock"]
    directions = [Factor("sliding", n, (DIRECTION * (spans[n][1] - spans[n][0]),)) for n in places]
    gates = [Factor("size", n) for n, q in own.items() if q.kind in ("speed", "force")]
    for law, kind, shares in (("fading", "speed", SPEEDS), ("decaying", "clock", DECAYS)):
        gates += [Factor(law, n, (s * _most(spans, n),)) for n, q in own.items() if q.kind == kind for s in shares]
    gates += [Factor("itself", n) for n, q in quantities.items() if q.kind == "state" and not q.own]
    gates += [h for n in places for h in _humps(n, spans)] if len(places) == 1 else []
    for a, b in combinations_with_replacement(carriers, 2):
        yield _one(a, b)
    for direction in directions:
        yield from (_one(direction, c) for c in (*carriers, *gates))
    if len(places) == 1:
        yield from (_one(c, g) for c in carriers for g in gates if c.quantity != g.quantity)


def _most(spans: Spans, name: str) -> float:
    return max(abs(spans[name][0]), abs(spans[name][1]))


def _humps(name: str, spans: Spans) -> list[Factor]:
    low, high, centres = spans[name]
    return [Factor("bump", name, (float(c), w * (high - low))) for c in centres for w in WIDTHS]


def _one(*factors: Factor) -> Group:
    return (Feature(tuple(sorted(factors))),)


def periodic(name: str, period: float, *carriers: Factor) -> Group:
    """Return sine and cosine of a quantity, times carriers."""
    return tuple(Feature((*carriers, Factor(law, name, (period,)))) for law in ("sine", "cosine"))
