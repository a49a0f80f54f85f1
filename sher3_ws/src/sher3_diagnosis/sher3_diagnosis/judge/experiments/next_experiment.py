"""The next experiment: what best tells the rivals of a cause apart, and the odds to be expected after it.

Every experiment that a machine can rehearse is predicted with each rival at work: the recorded runs as they were, and
those of the experiment as the rival's fit foretells them. All rivals are then fitted to both, as the next diagnosis
would do. How far they stay behind is turned into odds by the same calibration as in a verdict.

Whether the library holds the cause at all is doubted anew wherever its law was not yet looked at: no machine follows a
page exactly, and a bend that shows there is as much as a law that the library lacks. So what is promised is an average
over machines of the levels that the labelled ones have (`judge.level`), each with its own bend. It never says that the
library holds the cause with more odds than today: nobody can rehearse a law that nobody knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from sher3_diagnosis.attribute.rivals import unlikeness
from sher3_diagnosis.finding import Finding, Judged
from sher3_diagnosis.fit.fitting import Term, fit, make_term
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.fit.whitened import Whitened
from sher3_diagnosis.judge.bets import LISTED, term_of
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.experiments.foretold import LABELLED, foretold, with_bend
from sher3_diagnosis.judge.probabilities import shares_of
from sher3_diagnosis.machine import Machine, Rehearsal
from sher3_diagnosis.verdict import NextExperiment

SETTLED = 0.95
"""Share of the library's probability that one effect has once its rivals are told apart."""
FORMS = 4
"""Forms of a law that further runs choose among: what grows with the warmth, whether a mass hangs on its axis. Laws of
more forms have a number in them, which the recorded runs tell."""


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
    rehearsals = machine.of(finding.evidence).rehearsals(finding.evidence)
    for _, tries in groupby(rehearsals, key=lambda x: (x.added, x.elsewhere)):
        told = [(x, prospect(finding, judged, x.data)) for x in tries]
        likeliest = max(told, key=lambda t: (min(t[1].odds, enough), t[1].separation))
        if best is None or likeliest[1].odds > best[1].odds:
            best = likeliest
        if best[1].odds >= enough:
            break
    if best is None:
        return None
    levels = LABELLED if best[0].elsewhere else (0.0,)
    return best[0], prospect(finding, judged, best[0].data, levels, free=True)


@dataclass(frozen=True)
class Prospect:
    """What an experiment promises, on average over the rivals by their odds.

    Attributes:
        odds: probability after it of the effect that is at work.
        separation: by how much the closest of the others then stays behind, per sample, in squares of the floor.
    """

    odds: float
    separation: float


def prospect(
    finding: Finding, judged: Judged, more: Whitened, levels: Sequence[float] = (0.0,), free: bool = False
) -> Prospect:
    """Return what further runs would make of a cause and its rivals, each in turn taken to be at work.

    Args:
        finding: with all causes that were found.
        judged: the cause.
        more: the runs, of which no residual is looked at.
        levels: shares of a law's power by which it may be bent there, equally likely.
        free: whether a rival may take another form of its law on all runs together.
    """
    index, data = judged.item.index, finding.evidence.data
    assert index is not None
    others = [t for i, t in enumerate(finding.attribution.fit.terms) if i != index]
    open_ones = [k for k, p in enumerate(judged.effects) if p >= LISTED * judged.library]
    rivals = [term_of(finding, judged, k) for k in open_ones]
    beside, added = again(more, others), again(more, rivals)
    joined = [t.with_runs(x) for t, x in zip(others, beside, strict=True)]
    forms = [_forms(data, t) if free else [t] for t in rivals]
    terms = [[t.with_runs(x) for t, x in zip(f, again(more, f), strict=True)] for f in forms]
    weight = np.array([judged.effects[k] for k in open_ones])
    weight /= len(levels) * weight.sum()
    odds, apart = 0.0, 0.0
    for k, rival in enumerate(rivals):
        found = fit(data, [*others, rival])
        samples = sum(n for (_, c), n in more.samples.items() if c in rival.channels)
        for level in levels:
            both = data.with_runs(more, foretold(found, [*beside, added[k]], more, level))
            fits = [min((fit(both, [*joined, t]) for t in some), key=lambda f: f.total) for some in terms]
            worth = fit(both, joined).total - fits[k].total
            far = np.array([unlikeness(f, fits[k].total, worth) for f in fits])
            behind = [f.total - fits[k].total for f in fits if f is not fits[k]]
            library = with_bend(judged, fits[k], both, len(data.target), worth) if level else judged.library
            odds += weight[k] * library * shares_of(far, in_force())[k]
            apart += weight[k] * max(0.0, min(behind, default=0.0)) / max(1, samples)
    return Prospect(float(odds), float(apart))


def _forms(data: Whitened, term: Term) -> list[Term]:
    """Return a term and the other forms of its law, of which further runs may choose another; one of many stays."""
    shapes = [s for s in term.effect.shapes(data.views, term.site) if s != term.shape]
    return [term, *(make_term(data, term.effect, term.site, s) for s in shapes if len(shapes) < FORMS)]


def _is(finding: Finding, j: Judged, term: Term) -> bool:
    return j.item.index is not None and finding.attribution.fit.terms[j.item.index].key == term.key
