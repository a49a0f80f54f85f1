"""Which effects explain the gaps: forward selection with pairs, backward pass, and the rivals that cannot be told
apart.

All comparisons are of held-out loss (every run scored with coefficients fitted to the others), in units of the floor.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import combinations

from sher3_gap.channels import Channel
from sher3_gap.constancy import constancy_of
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit, Term, fit, make_term
from sher3_gap.library import LIBRARY, LibraryEffect, Shape

MAX_CAUSES = 3
PRICE = 12.0
"""Held-out loss that a coefficient or shape parameter must buy."""
AS_BUILT_PRICE = 0.05
"""What a coefficient must buy in addition at the tip and the force sensor, per sample: the robot as built deviates from
its drawing by a fraction of the floor that no repeat shows, and every coefficient takes its part of that."""
UNLIKELY = 3.0 * PRICE
"""What an effect must buy in addition where its sign speaks for another one."""
PARSIMONY = 0.004
"""The same as a share of what the effect explains."""
WORTH = 0.35
"""Share of the gap that is left which a further cause must explain."""
RIVAL = 0.02
"""A rival explains all but this share of what the chosen effect explains."""

ROUNDS = 3
"""Rounds of the search over shapes: the effect's own, then around the best so far."""
RANKED = 6
"""Effects kept in the ranking of a cause."""

Progress = Callable[[str], None]


@dataclass
class Candidates:
    """Fits of every effect of the library at every site, given causes already chosen; terms are evaluated once."""

    evidence: Evidence
    without: Collection[str] = ()
    cache: dict[tuple, Term] = field(default_factory=dict)

    def effects(self) -> Iterable[LibraryEffect]:
        """Effects of the library that may be used."""
        return (e for name, e in LIBRARY.items() if name not in self.without)

    def term(self, effect: LibraryEffect, site: str, shape: Shape) -> Term:
        """Evaluate a term once."""
        key = (effect.id, site, tuple(sorted(shape.items())))
        if key not in self.cache:
            self.cache[key] = make_term(self.evidence.data, effect, site, shape)
        return self.cache[key]

    def best(self, effect: LibraryEffect, site: str, given: Sequence[Term] = ()) -> Fit | None:
        """Best shape of an effect at a site together with the terms given (the effect is the last term)."""
        found: Fit | None = None
        shapes = effect.shapes(self.evidence.views, site)
        for _ in range(ROUNDS):
            before = found
            for shape in shapes:
                trial = fit(self.evidence.data, [*given, self.term(effect, site, shape)])
                if self._allowed(trial) and (found is None or cost(trial) < cost(found)):
                    found = trial
            if found is None or found is before:
                break
            shapes = effect.refine(found.terms[-1].shape)
        return found

    @staticmethod
    def _allowed(trial: Fit) -> bool:
        last = len(trial.terms) - 1
        term = trial.terms[last]
        return bool(term.channels) and term.effect.admissible(term.shape, trial.of(last))

    def search(self, channels: Collection[Channel], given: Sequence[Term] = ()) -> list[Fit]:
        """Fit every effect that shows on any of `channels`, best first.

        Without those a simpler relative explains as well.
        """
        taken = {t.key for t in given}
        out: list[Fit] = []
        for effect in self.effects():
            for site in effect.sites():
                if (effect.id, site) in taken or not set(effect.channels(site)) & set(channels):
                    continue
                found = self.best(effect, site, given)
                if found is not None:
                    out.append(found)
        return sorted(self._without_idle_extensions(out, given), key=cost)

    def _without_idle_extensions(self, fits: list[Fit], given: Sequence[Term]) -> list[Fit]:
        base = fit(self.evidence.data, given).total
        loss = {f.terms[-1].key: f.total for f in fits}
        kept = []
        for f in fits:
            effect, site = f.terms[-1].effect, f.terms[-1].site
            simpler = min((loss[b, site] for b in effect.extends if (b, site) in loss), default=None)
            explained = base - f.total
            if simpler is None or simpler - f.total > max(3.0 * PRICE, 2.0 * PARSIMONY * explained):
                kept.append(f)
        return kept


def complexity(term: Term) -> int:
    """Number of free numbers of a term."""
    return term.width + len(term.shape)


def cost(trial: Fit) -> float:
    """Held-out loss plus the price of the last term's complexity."""
    if not trial.terms:
        return trial.total
    last = len(trial.terms) - 1
    term = trial.terms[last]
    doubt = UNLIKELY if term.effect.unlikely(term.shape, trial.of(last)) else 0.0
    return trial.total + price(term) + doubt


def price(term: Term) -> float:
    """Held-out loss that the last term's numbers must buy."""
    return PRICE * complexity(term) + AS_BUILT_PRICE * samples_at_tip(term) * term.width


def samples_at_tip(term: Term) -> int:
    """Samples of the tip on which a term shows."""
    return sum(len(x) for run in term.columns for c, x in run.items() if c.stage in ("mechanism", "structure"))


@dataclass(frozen=True)
class Attribution:
    """Chosen causes, jointly fitted, and for each the effects that explain as much."""

    fit: Fit
    rivals: tuple[tuple[Fit, ...], ...]
    explained: tuple[float, ...]
    """Loss that removing each cause (and refitting the others) adds."""
    ranking: tuple[tuple[Fit, ...], ...] = ()
    """For each cause the effects that come closest to it in its place, best first, itself among them."""


def attribute(
    evidence: Evidence, significant: Callable[[Fit], dict[Channel, float]], candidates: Candidates, say: Progress
) -> Attribution:
    """Select causes until no gap is left that an effect explains.

    `significant(fit)` returns {channel: excess loss} of the gaps that are left under a fit.
    """
    chosen: list[Term] = []
    current = fit(evidence.data, [])
    while len(chosen) < MAX_CAUSES:
        left = significant(current)
        if not left:
            break
        say(f"explaining {', '.join(map(str, sorted(left)))}")
        step = _step(candidates, current, chosen, left)
        if step is None:
            break
        current = step
        chosen = list(current.terms)
    current = _prune(evidence, current, significant)
    found = _with_rivals(evidence, current, candidates)
    steady = _steadier(evidence, found)
    return found if steady is None else _with_rivals(evidence, steady, candidates)


def _gain(before: Fit, after: Fit, left: dict[Channel, float]) -> float:
    """Largest share of a remaining gap that a fit explains."""
    best = 0.0
    for channel, excess in left.items():
        was = sum(v for (_, c), v in before.loss.items() if c == channel)
        now = sum(v for (_, c), v in after.loss.items() if c == channel)
        best = max(best, (was - now) / excess)
    return best


def _step(candidates: Candidates, current: Fit, chosen: list[Term], left: dict[Channel, float]) -> Fit | None:
    found = candidates.search(left, chosen)
    if not found:
        return None
    best = found[0]
    gain = _gain(current, best, left)
    if gain < 0.8 and len(chosen) + 2 <= MAX_CAUSES:
        pair = _pair(candidates, current, chosen, found[:6], left)
        if pair is not None and _gain(current, pair, left) > max(gain + 0.15, 0.6):
            return pair
    if gain < WORTH:
        return None
    return best


def _pair(
    candidates: Candidates, current: Fit, chosen: list[Term], found: list[Fit], left: dict[Channel, float]
) -> Fit | None:
    best: Fit | None = None
    for a, b in combinations([f.terms[-1] for f in found], 2):
        if a.key == b.key or not a.channels & b.channels:
            continue
        trial = fit(candidates.evidence.data, [*chosen, a, b])
        if trial.admissible and (best is None or trial.total < best.total):
            best = trial
    return best


def _prune(evidence: Evidence, current: Fit, significant: Callable[[Fit], dict[Channel, float]]) -> Fit:
    """Backward pass: drop a cause whose loss nobody misses."""
    base = fit(evidence.data, []).total
    while len(current.terms) > 1:
        kept = range(len(current.terms))
        reduced = [fit(evidence.data, [t for j, t in enumerate(current.terms) if j != i]) for i in kept]
        worth = [f.total - current.total for f in reduced]
        i = min(kept, key=worth.__getitem__)
        price = 3.0 * PRICE * complexity(current.terms[i]) + PARSIMONY * (base - current.total)
        if worth[i] > price or set(significant(reduced[i])) - set(significant(current)):
            return current
        current = reduced[i]
    return current


def _steadier(evidence: Evidence, found: Attribution) -> Fit | None:
    """Where a cause changes size between excitations and a rival does not, the fit with that rival in its place."""
    for i in range(len(found.fit.terms)):
        if constancy_of(evidence, found.fit, i).constant:
            continue
        for rival in found.rivals[i]:
            terms = [*found.fit.terms[:i], rival.terms[-1], *found.fit.terms[i + 1 :]]
            trial = fit(evidence.data, terms)
            if trial.admissible and constancy_of(evidence, trial, i).constant:
                return trial
    return None


def _with_rivals(evidence: Evidence, current: Fit, candidates: Candidates) -> Attribution:
    rivals: list[tuple[Fit, ...]] = []
    explained: list[float] = []
    ranking: list[tuple[Fit, ...]] = []
    for i, term in enumerate(current.terms):
        others = [t for j, t in enumerate(current.terms) if j != i]
        without = fit(evidence.data, others).total
        worth = without - current.total
        ranked = candidates.search(term.channels, others)
        ranking.append(tuple(ranked[:RANKED]))
        alike = [f for f in ranked if _alike(f, current, worth)]
        rivals.append(tuple(f for f in alike if f.terms[-1].effect.id != term.effect.id))
        explained.append(worth)
    return Attribution(current, tuple(rivals), tuple(explained), tuple(ranking))


def _alike(rival: Fit, chosen: Fit, worth: float) -> bool:
    """Whether a rival explains as much: all but a share, and at the tip but for what the robot as built deviates by.

    The share is of the gap with its floor: rounding repeats, so that a small part of the floor is no evidence. Each
    coefficient takes its part of the deviations as built, so that a rival with fewer of them may leave more.
    """
    floor = sum(len(x) for run in rival.terms[-1].columns for c, x in run.items() if c.actuator != "tip")
    margin = max(3.0 * PRICE, RIVAL * (worth + floor))
    built = AS_BUILT_PRICE * max(samples_at_tip(rival.terms[-1]), *(samples_at_tip(t) for t in chosen.terms), 0)
    apart = {k: rival.loss[k] - x for k, x in chosen.loss.items()}
    tip = sum(x for (_, c), x in apart.items() if c.actuator == "tip")
    missing = max(0, max(t.width for t in chosen.terms) - rival.terms[-1].width)
    widest = 2.0 * built * (2 + missing)
    return tip < max(3.0 * PRICE, min(margin, widest), built) and sum(apart.values()) - tip < margin
