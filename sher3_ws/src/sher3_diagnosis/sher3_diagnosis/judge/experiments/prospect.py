"""What further runs would make of the odds of a cause and its rivals, each in turn taken to be at work.

The recorded runs stay as they were, and those to come are as the rival's fit foretells them. All rivals are then fitted
to both, as the next diagnosis would do; how far they stay behind is turned into odds as in a verdict. Where it is open
which form a rival's law has, each form may be at work, and each may stand in for another effect.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.attribute.candidates import possible
from sher3_diagnosis.attribute.rivals import unlikeness
from sher3_diagnosis.finding import Finding, Judged
from sher3_diagnosis.fit.fitting import Fit, Term, connected, fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.fit.tolerance import AsBuilt
from sher3_diagnosis.judge.bets import LISTED, term_of
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.experiments.prediction import bend_of, predicted, with_bend
from sher3_diagnosis.judge.probabilities import shares_of

FORMS = 10
"""Forms of a law that further runs choose among: what grows with the warmth, whether a mass hangs on its axis, which
force shows on which axis. Laws of more forms have a number in them, which the recorded runs tell."""


Alike = Sequence[frozenset[int]]
"""For each law the effects that nothing tells from it, its own among them."""


@dataclass(frozen=True)
class Outcome:
    """What an experiment leads to where one law is at work.

    Attributes:
        law: its number.
        odds: that this law is at work, if one of the laws is.
        library: probability after it that the library holds the cause.
        far: unlikeness of each effect to it.
        shares: of the library's probability, of each effect.
        behind: by how much the closest of the others stays behind, per sample, in squares of the floor.
    """

    law: int
    odds: float
    library: float
    far: Mapping[int, float]
    shares: Mapping[int, float]
    behind: float


@dataclass(frozen=True)
class Prospect:
    """What an experiment promises: an outcome for each law that may be at work."""

    outcomes: Sequence[Outcome]

    @property
    def separation(self) -> float:
        """By how much the closest rival stays behind, per sample, on average over the laws."""
        return sum(o.odds * o.behind for o in self.outcomes)

    def odds(self, alike: Alike) -> float:
        """Return the probability after it of what is at work, and of what nothing tells from it, over the laws."""
        return sum(self.by_law(alike))

    def by_law(self, alike: Alike) -> list[float]:
        """Return what each law, where it is at work, adds to these odds."""
        out = [0.0] * len(alike)
        for o in self.outcomes:
            out[o.law] += o.odds * o.library * sum(o.shares[k] for k in o.shares.keys() & alike[o.law])
        return out


@dataclass(frozen=True)
class Law:
    """A form of a rival's law that the recorded runs leave open.

    Attributes:
        effect: number of the rival among the candidates.
        odds: that it is at work, if one of the laws is.
        found: the fit to the recorded runs, this law last.
    """

    effect: int
    odds: float
    found: Fit


@dataclass(frozen=True)
class Rivals:
    """A cause and its rivals in all forms of their laws that explain the recorded runs as well."""

    judged: Judged
    data: Standardised
    laws: Sequence[Law]

    @classmethod
    def of(cls, finding: Finding, judged: Judged) -> Rivals:
        """Return those of a cause; the finding has all causes. Forms of one law share its odds as effects do.

        What acts elsewhere is left out: it is the same whichever law is at work.
        """
        index, data, laws = judged.item.index, finding.evidence.data, []
        assert index is not None
        rivals = {k: term_of(finding, judged, k) for k in sharing(judged)}
        others = _beside(finding.attribution.fit.others(index), list(rivals.values()))
        worth = fit(data, others).total - fit(data, [*others, rivals[min(rivals)]]).total
        whole = sum(judged.effects[k] for k in rivals)
        for k, term in rivals.items():
            own, *other = (fit(data, [*others, t]) for t in _forms(data, term))
            forms = [own, *(f for f in other if possible(f))]
            far = np.array([unlikeness(f, own.total, worth) for f in forms])
            odds = shares_of(far, in_force()) * judged.effects[k] / whole
            laws += [Law(k, float(p), f) for p, f in zip(odds, forms, strict=True) if p >= LISTED]
        return cls(judged, data, laws)

    def prospect(
        self, more: Standardised, levels: Sequence[float] = (0.0,), built: Sequence[Term] | None = None
    ) -> Prospect:
        """Return what further runs would make of the odds.

        Args:
            more: the runs, of which no residual is looked at.
            levels: shares of a law's power by which it may be bent there, equally likely.
            built: deviations within tolerance that recorded and further runs show; None for those of the recorded runs.
        """
        others, terms = self.laws[0].found.terms[:-1], [law.found.terms[-1] for law in self.laws]
        beside, added = again(more, others), again(more, terms)
        joined, *tried = (
            [t.with_runs(x) for t, x in zip(a, b, strict=True)]
            for a, b in ((others, beside), *(([t], [x]) for t, x in zip(terms, added, strict=True)))
        )
        if built is not None:
            causes = [t for t in joined if not isinstance(t.effect, AsBuilt)]
            joined = [*_beside(built, [*causes, *(t for x in tried for t in x)]), *causes]
        outcomes, bend = [], bend_of(more)
        for i, (law, own) in enumerate(zip(self.laws, added, strict=True)):
            samples = sum(n for (_, c), n in more.samples.items() if c in own.channels)
            for level in levels:
                both = self.data.with_runs(more, predicted(law.found, [*beside, own], more, level, bend))
                best = self._best([fit(both, [*joined, *t]) for t in tried])
                after = best[law.effect]
                worth = fit(both, joined).total - after.total
                library = with_bend(self.judged, law.found, after, both, worth) if level else self.judged.library
                far = {k: unlikeness(f, after.total, worth) if k != law.effect else 0.0 for k, f in best.items()}
                behind = min((f.total - after.total for k, f in best.items() if k != law.effect), default=0.0)
                shares = shares_of(np.array(list(far.values())), in_force()).tolist()
                odds, behind = law.odds / len(levels), max(0.0, behind) / max(1, samples)
                outcomes.append(Outcome(i, odds, library, far, dict(zip(far, shares, strict=True)), behind))
        return Prospect(outcomes)

    @property
    def felt(self) -> frozenset[str]:
        """Quantities that the laws depend on, and the causes beside them: what changes none of these parts nothing."""
        return frozenset(x for law in self.laws for term in law.found.terms for x in term.effect.inputs)

    @property
    def each(self) -> Alike:
        """Every effect by itself."""
        return [frozenset({law.effect}) for law in self.laws]

    def inseparable(self, prospects: Sequence[Prospect]) -> Alike:
        """Return what no experiment tells apart: where a law is at work, such an effect explains as much in all."""
        parted: list[set[int]] = [set() for _ in self.laws]
        for o in (o for p in prospects for o in p.outcomes):
            parted[o.law] |= {k for k, far in o.far.items() if far >= 1.0}
        return [frozenset({law.effect for law in self.laws} - x) for x in parted]

    def one_answer(self, effect: int, alike: Alike) -> set[int]:
        """Return the effects that are one answer with an effect, whichever of them is at work in whichever form."""
        every = [(law.effect, x) for law, x in zip(self.laws, alike, strict=True)]
        return {k for k, _ in every if all({effect, k} <= x for e, x in every if e in (effect, k))}

    def _best(self, fits: Sequence[Fit]) -> dict[int, Fit]:
        """Return the best fit of each effect, of one fit for each law."""
        ranked = sorted(zip(self.laws, fits, strict=True), key=lambda x: -x[1].total)
        return {law.effect: f for law, f in ranked}


def sharing(j: Judged) -> list[int]:
    """Return the numbers of the candidates that share the odds of the library."""
    return [k for k, p in enumerate(j.effects) if p >= LISTED * j.library]


def _beside(terms: Sequence[Term], laws: Sequence[Term]) -> list[Term]:
    """Return the terms that share channels with some laws, or with a term that does."""
    groups = connected([*terms, *laws])
    near = {i for group in groups for i in group if any(k >= len(terms) for k in group)}
    return [t for i, t in enumerate(terms) if i in near]


def _forms(data: Standardised, term: Term) -> list[Term]:
    """Return a term and the other forms of its law; one of many stays as it is."""
    shapes = [s for s in term.effect.shapes(data.views, term.site) if s != term.shape]
    return [term, *(make_term(data, term.effect, term.site, s) for s in shapes if len(shapes) < FORMS)]
