"""The next experiment: what best tells the rivals of a cause apart, and the odds to be expected after it.

Every experiment that a machine can rehearse is predicted with each rival at work: the recorded runs as they were, and
those of the experiment as the rival's fit foretells them. All rivals are then fitted to both, as the next diagnosis
would do. How far they stay behind is turned into odds by the same calibration as in a verdict. Whether the library
holds the cause at all is another question, on which nothing is known beforehand: the odds of that stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from sher3_diagnosis.attribute.rivals import unlikeness
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.finding import Finding, Judged
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.fit.whitened import Whitened
from sher3_diagnosis.judge.bets import LISTED, term_of
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.probabilities import shares_of
from sher3_diagnosis.machine import Machine, Rehearsal
from sher3_diagnosis.verdict import NextExperiment

SETTLED = 0.95
"""Share of the library's probability that one effect has once its rivals are told apart."""


def next_experiment(machine: Machine, finding: Finding) -> NextExperiment | None:
    """Propose an experiment for the first cause with rivals; None when no cause has one.

    Where the machine rehearses none, it is the excitation that shows the closest rival best, and nothing is foretold.
    """
    found = finding.attribution
    i = next((i for i, rivals in enumerate(found.rivals) if rivals), None)
    if i is None:
        return None
    chosen, rivals = found.fit.terms[i], found.rivals[i]
    ids = list(dict.fromkeys([chosen.effect.id, *(f.terms[-1].effect.id for f in rivals)]))
    whole = finding.with_all
    judged = next((j for j in finding.judged if _is(whole, j, chosen)), None)
    best = None if judged is None else best_of(machine, whole, judged)
    if best is None:
        shows = (rivals[0].terms[-1] if len(ids) > 1 else chosen).effect.best
        return NextExperiment(excitation=shows.excitation, purpose=shows.why, separates=ids, predicted_separation=None)
    tried, promise = best
    return NextExperiment(
        excitation=tried.excitation,
        purpose=tried.purpose,
        added=tried.added,
        separates=ids,
        predicted_separation=promise.separation,
        expected_odds=promise.odds,
    )


def best_of(machine: Machine, finding: Finding, judged: Judged) -> tuple[Rehearsal, Prospect] | None:
    """Return the experiment that promises most; what the recorded runs had not is added only where it is needed."""
    enough = SETTLED * judged.library
    best = None
    for _, tries in groupby(machine.of(finding.evidence).rehearsals(finding.evidence), key=lambda x: x.added):
        told = [(x, prospect(finding, judged, x.data)) for x in tries]
        likeliest = max(told, key=lambda t: (min(t[1].odds, enough), t[1].separation))
        if best is None or likeliest[1].odds > best[1].odds:
            best = likeliest
        if best[1].odds >= enough:
            break
    return best


@dataclass(frozen=True)
class Prospect:
    """What an experiment promises, on average over the rivals by their odds.

    Attributes:
        odds: probability after it of the effect that is at work.
        separation: by how much the closest of the others then stays behind, per sample, in squares of the floor.
    """

    odds: float
    separation: float


def prospect(finding: Finding, judged: Judged, more: Whitened) -> Prospect:
    """Return what further runs would make of a cause and its rivals, each in turn taken to be at work."""
    index, data = judged.item.index, finding.evidence.data
    assert index is not None
    others = [t for i, t in enumerate(finding.attribution.fit.terms) if i != index]
    open_ones = [k for k, p in enumerate(judged.effects) if p >= LISTED * judged.library]
    rivals = [term_of(finding, judged, k) for k in open_ones]
    beside, added = again(more, others), again(more, rivals)
    joined = [t.with_runs(x) for t, x in zip(others, beside, strict=True)]
    terms = [t.with_runs(x) for t, x in zip(rivals, added, strict=True)]
    odds, apart = [], []
    for k, rival in enumerate(rivals):
        target = foretold(fit(data, [*others, rival]), [*beside, added[k]], more)
        both = data.with_runs(more, target)
        fits, bare = [fit(both, [*joined, t]) for t in terms], fit(both, joined).total
        worth = bare - fits[k].total
        far = np.array([unlikeness(f, fits[k].total, worth) for f in fits])
        samples = sum(n for (_, c), n in more.samples.items() if c in terms[k].channels)
        odds.append(float(shares_of(np.maximum(far, 0.0), in_force())[k]))
        behind = [f.total - fits[k].total for f in fits if f is not fits[k]]
        apart.append(max(0.0, min(behind, default=0.0)) / max(1, samples))
    weight = np.array([judged.effects[k] for k in open_ones])
    weight /= weight.sum()
    return Prospect(judged.library * float(weight @ odds), float(weight @ apart))


def foretold(found: Fit, added: Sequence[Term], more: Whitened) -> list[dict[Channel, Array]]:
    """Return what the terms of a fit add to further runs, per run and channel (N,), over the floor."""
    out = [{c: np.zeros(len(y)) for c, y in seen.items()} for seen in more.target]
    for i, term in enumerate(added):
        for r, total in enumerate(out):
            for c in total:
                total[c] = total[c] + term.adds(r, c, found.of(i))
    return out


def _is(finding: Finding, j: Judged, term: Term) -> bool:
    return j.item.index is not None and finding.attribution.fit.terms[j.item.index].key == term.key
