"""Fits of every effect at every site it may sit on, given the causes already chosen."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field

from sher3_diagnosis.attribute.ties import TIE, ranked
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect, Shape
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit, make_term
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY, PRICE

ROUNDS = 3
"""Rounds of the search over shapes: the effect's own, then twice around the best so far."""


def possible(trial: Fit) -> bool:
    """Return whether the last term shows anywhere and its fit is physically possible."""
    last = len(trial.terms) - 1
    term = trial.terms[last]
    return bool(term.channels) and term.effect.admissible(term.shape, trial.of(last))


def as_found(candidates: Candidates, trials: list[Fit], given: Sequence[Term]) -> list[Fit]:
    """Return the trials of a step as they are: the cheapest first."""
    return trials


Order = Callable[["Candidates", list[Fit], Sequence[Term]], list[Fit]]
"""Says in which order the trials of a step are taken, and which not at all: of candidates, trials and terms given."""


@dataclass
class Candidates:
    """The effects that may be causes of one piece of evidence; terms are evaluated once.

    Attributes:
        evidence: to be explained.
        effects: that may explain it.
        possible: whether a trial may be an answer.
        order: of the trials of a step.
        found: the best fits so far, with the terms they were found beside: steps and rivals ask for the same again.
    """

    evidence: Evidence
    effects: Sequence[Effect]
    possible: Callable[[Fit], bool] = possible
    order: Order = as_found
    terms: dict[tuple, Term] = field(default_factory=dict)
    found: dict[tuple, tuple[Sequence[Term], Fit | None]] = field(default_factory=dict, init=False, repr=False)

    def sites(self, effect: Effect) -> Sequence[str]:
        """Return where an effect may sit."""
        return [site for place in effect.places for site in self.evidence.places.get(place, ())]

    def term(self, effect: Effect, site: str, shape: Shape) -> Term:
        """Evaluate a term once."""
        key = (effect.id, site, tuple(sorted(shape.items())))
        if key not in self.terms:
            self.terms[key] = make_term(self.evidence.data, effect, site, shape)
        return self.terms[key]

    def best(self, effect: Effect, site: str, given: Sequence[Term] = ()) -> Fit | None:
        """Fit the best shape of an effect together with the terms given; the effect is the last term.

        A shape with a bend is another answer only where the best one without leaves a share that the page names.

        Returns:
            None when no shape is physically possible, or the effect does not show in the evidence.
        """
        key = (effect.id, site, *map(id, given))
        if key not in self.found:
            self.found[key] = tuple(given), self._best(effect, site, given)
        return self.found[key][1]

    def _best(self, effect: Effect, site: str, given: Sequence[Term]) -> Fit | None:
        plain = self._searched(effect, site, given, effect.shapes(self.evidence.views, site))
        base = fit(self.evidence.data, given).total
        if plain is None or base - plain.total < NEEDED:
            return plain
        bent = self._searched(effect, site, given, effect.bends(self.evidence.views, site, plain.terms[-1].shape))
        if bent is None or plain.total - bent.total < effect.bent_from * (base - bent.total):
            return plain
        return min(plain, bent, key=cost)

    def best_plain(self, effect: Effect, site: str, given: Sequence[Term]) -> Fit | None:
        """Fit the best shape of a plain law beside the terms given; None where none is possible."""
        return self._searched(effect, site, given, effect.plain_shapes(self.evidence.views, site))

    def best_plainer(self, term: Term, given: Sequence[Term]) -> Fit | None:
        """Fit the best shape of a term's effect with fewer numbers than its own; None where it has none."""
        shapes = term.effect.plainer(self.evidence.views, term.site, term.shape)
        return self._searched(term.effect, term.site, given, shapes)

    def _searched(self, effect: Effect, site: str, given: Sequence[Term], shapes: list[Shape]) -> Fit | None:
        """Fit the best of some shapes and of those near it."""
        found: Fit | None = None
        for _ in range(ROUNDS):
            before = found
            for shape in (s for s in shapes if effect.allowed(self.evidence.views, site, s)):
                trial = fit(self.evidence.data, [*given, self.term(effect, site, shape)])
                if self.possible(trial) and (found is None or cost(trial) < cost(found) - TIE):
                    found = trial
            if found is None or found is before:
                break
            shapes = effect.refine(found.terms[-1].shape)
        return found

    def search(self, channels: Collection[Channel], given: Sequence[Term] = ()) -> list[Fit]:
        """Fit every effect that shows on any of `channels`, best first; of equals, the law of fewest inputs first.

        An effect that contains a simpler one is left out unless it explains markedly more than that one does.
        """
        taken = {t.key for t in given}
        out: list[Fit] = []
        for effect in self.effects:
            for site in self.sites(effect):
                if (effect.id, site) in taken or not set(effect.channels(site)) & set(channels):
                    continue
                found = self.best(effect, site, given)
                if found is not None:
                    out.append(found)
        return self.order(self, ranked(self._without_idle_extensions(out, given), cost, inputs_of), given)

    def _without_idle_extensions(self, fits: list[Fit], given: Sequence[Term]) -> list[Fit]:
        base = fit(self.evidence.data, given).total
        loss = {f.terms[-1].key: f.total for f in fits}
        kept = []
        for f in fits:
            effect, site = f.terms[-1].effect, f.terms[-1].site
            simpler = min((loss[b, site] for b in effect.extends if (b, site) in loss), default=None)
            if simpler is None or simpler - f.total > max(NEEDED, 2.0 * PARSIMONY * (base - f.total)):
                kept.append(f)
        return kept


def complexity(term: Term) -> int:
    """Return the number of free numbers of a term."""
    return term.width + len(term.shape.keys() - set(term.effect.about))


def inputs_of(trial: Fit) -> int:
    """Return the number of quantities that the law of the last term depends on."""
    return len(trial.terms[-1].effect.inputs)


def cost(trial: Fit) -> float:
    """Return the held-out loss plus the price of the last term's numbers."""
    return trial.total + (price(trial.terms[-1]) if trial.terms else 0.0)


def price(term: Term) -> float:
    """Return the held-out loss that a term's numbers must buy."""
    return PRICE * complexity(term)
