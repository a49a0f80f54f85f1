"""How the causes of one axis are looked for: the engine's search, and two that begin with a dry friction.

A load behind a gap or a spring shows in the effort only beside the friction, whose reversal it shapes: step by step a
friction that builds up slowly would be taken for both. One search therefore looks for it second.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates, complexity, cost, price
from sher3_diagnosis.attribute.rivals import Attribution, with_rivals
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.attribute.ties import TIE
from sher3_diagnosis.attribute.together import pruned, together
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, PRICE, WORTH

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.axes.identification.balance_at_rest import DryFirst, rest_loss
from sher3_chain.axes.identification.confounded_laws import told_by_travel
from sher3_chain.axes.view import AxisView
from sher3_chain.search.away_from_reversals import borne_out
from sher3_chain.search.bounded import Bounded

POLISHES = 4
"""Rounds over the causes at most: the second lets the first cause see the polished last one."""


def causes_of_axis(evidence: AxisEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of an axis, without those that only its reversals show."""
    return borne_out(evidence, told_by_travel(_chosen(evidence, candidates, left_over, say)))


def _chosen(evidence: AxisEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of an axis.

    Where the choice leaves a force at rest that nothing holds, a second search starts with a dry friction. Of the two
    the one with the smaller loss is taken, in motion and at rest together.
    """
    candidates = Bounded(evidence, candidates.effects, candidates.terms)
    seen = [e for e in candidates.effects if not e.unseen]
    found = _plain_first(evidence, Bounded(evidence, seen, candidates.terms), left_over, say)
    if rest_loss(evidence, found.fit) > 0.0:
        dry = DryFirst(evidence, seen, candidates.terms)
        other = attribute(dry, left_over, say)
        found = min((found, other), key=lambda a: a.fit.total + rest_loss(evidence, a.fit))
    behind = Behind(evidence, candidates.effects, candidates.terms)
    if behind.looks:
        other = attribute(behind, left_over, say)
        if _excess(evidence, other.fit) < (1.0 - WORTH) * _excess(evidence, found.fit):
            found = other
    found = _refined(candidates, found, left_over)
    return replace(found, rivals=_at_rest_too(evidence, found))


def _plain_first(evidence: AxisEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Fit the plain laws at once and look for richer ones in what they leave; where a gap is left, search by steps too.

    Of the two the one is taken whose loss, with the price of its numbers, is smaller.
    """
    say("fitting the plain laws together")
    null = evidence.null()
    plain = together(candidates, evidence.channels, left_over) if left_over(null) else null
    found = _refined(candidates, attribute(candidates, left_over, say, start=plain), left_over)
    if not left_over(found.fit):
        return found
    return min((found, _refined(candidates, attribute(candidates, left_over, say), left_over)), key=_priced)


def _refined(candidates: Candidates, found: Attribution, left_over: Left) -> Attribution:
    """Return an attribution whose causes were searched again beside the others, without those nobody misses then."""
    best = pruned(candidates.evidence, polished(candidates, found), left_over, relative=True)
    if [t.effect.id for t in best.terms] == [t.effect.id for t in found.fit.terms]:
        return replace(found, fit=best)
    return with_rivals(candidates, best)


def _priced(found: Attribution) -> float:
    return found.fit.total + sum(price(found.fit.terms[i]) for i in found.causes)


class Behind(Bounded):
    """Candidates of which the first two causes are plain dry friction and what hides behind one encoder."""

    FAMILIES = ("compliance", "timing")
    """Beside plain friction: of what hides a spring that rings; then all that hides, or a late effort.

    A load that gives way is late too.
    """

    @property
    def looks(self) -> bool:
        """Whether there is anything that hides behind one encoder."""
        views = [v for v in self.evidence.views if isinstance(v, AxisView)]
        unseen = [e for e in self.effects if e.unseen]
        return any(e.shapes(views, site) for e in unseen for site in self.sites(e)) if views else False

    def search(self, channels: Collection[Channel], given: Sequence[Term] = ()) -> list[Fit]:
        """Search as the engine does, but for the first two causes in this order."""
        found, chosen = super().search(channels, given), len(given) - len(self.evidence.nuisance)
        if chosen >= len(self.FAMILIES):
            return found
        of_order = [trial for trial in found if self._in_turn(trial.terms[-1].effect, chosen)]
        if not chosen:
            return of_order
        sharp = [self._beside(trial, self._sharp(given)) for trial in of_order]
        return sorted((self._beside(trial, given) for trial in [*of_order, *sharp]), key=cost)

    def _in_turn(self, effect: Effect, chosen: int) -> bool:
        """Return whether an effect may be the first cause, or the second."""
        hides = effect.unseen and bool(chosen)
        return (effect.plain and effect.dry) or hides or effect.family == self.FAMILIES[chosen]

    def _sharp(self, given: Sequence[Term]) -> Sequence[Term]:
        """Return terms with a friction that reverses at once: alone it builds up as slowly as the load comes in."""
        *before, friction = given
        shapes = friction.effect.shapes(self.evidence.views, friction.site)
        return [*before, self.term(friction.effect, friction.site, shapes[0])]

    def _beside(self, trial: Fit, given: Sequence[Term]) -> Fit:
        """Return a fit whose last two causes are searched again beside each other, from the given friction on."""
        (*before, friction), load, best = given, trial.terms[-1], trial
        for _ in range(POLISHES):
            again = self.best(load.effect, load.site, [*before, friction])
            rubs = again and self.best(friction.effect, friction.site, [*before, again.terms[-1]])
            if again is None or rubs is None:
                break
            best, friction = min(best, again, key=lambda f: f.total), rubs.terms[-1]
        return best


def _excess(evidence: AxisEvidence, found: Fit) -> float:
    """Return the loss of a fit above the floor, in motion and at rest."""
    return found.total - sum(evidence.data.samples.values()) + rest_loss(evidence, found)


def _at_rest_too(evidence: AxisEvidence, found: Attribution) -> tuple[tuple[Fit, ...], ...]:
    """Return the rivals that leave no more at rest than the causes do: what motion cannot tell, rest may."""
    most = rest_loss(evidence, found.fit) + NEEDED
    return tuple(tuple(f for f in rivals if rest_loss(evidence, f) < most) for rivals in found.rivals)


def polished(candidates: Candidates, found: Attribution) -> Fit:
    """Search every cause again beside the others, and its rivals in its place: it was chosen before they were there.

    The causes keep their order.
    """
    best = found.fit
    for _ in range(POLISHES):
        before = best
        for i in found.causes:
            term = best.terms[i]
            others = [t for j, t in enumerate(best.terms) if j != i]
            effects = [term.effect, *(f.terms[-1].effect for f in found.rivals[i] if f.terms[-1].site == term.site)]
            for effect in effects:
                trial = candidates.best(effect, term.site, others)
                if trial is None:
                    continue
                if _gain(candidates.evidence, best, i, trial) > TIE:
                    best = fit(candidates.evidence.data, [*others[:i], trial.terms[-1], *others[i:]])
        if best is before:
            break
    return best


def _gain(evidence: Evidence, best: Fit, index: int, trial: Fit) -> float:
    """Return what is won by the last law of `trial` in the place of one cause.

    A law of more numbers must be needed. One of fewer may lose their price; what lies below the floor is no loss.
    """
    more = complexity(trial.terms[-1]) - complexity(best.terms[index])
    if more < 0:
        return _over_floor(evidence, best) - _over_floor(evidence, trial) - PRICE * more
    return best.total - trial.total - NEEDED * more


def _over_floor(evidence: Evidence, found: Fit) -> float:
    """Return the loss above the floor, channel by channel: what is spared in one pays for nothing in another."""
    return sum(max(0.0, loss - evidence.data.samples[key]) for key, loss in found.loss.items())
