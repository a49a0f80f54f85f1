"""The next experiment: what best tells the rivals of a cause apart, and the odds to be expected after it.

Whether the library holds the cause at all is doubted anew wherever its law was not yet looked at: no machine follows a
page exactly, and a bend that shows there is as much as a law that the library lacks. So what is promised is an average
over machines of the levels that the labelled ones have (`judge.level`), each with its own bend. It never says that the
library holds the cause with more odds than today: nobody can rehearse a law that nobody knows.
"""

from __future__ import annotations

from itertools import groupby

from sher3_diagnosis.finding import Finding, Judged
from sher3_diagnosis.judge.bets import LISTED, term_of
from sher3_diagnosis.judge.experiments.prediction import LABELLED
from sher3_diagnosis.judge.experiments.prospect import Prospect, Rivals, sharing
from sher3_diagnosis.machine import Machine, Rehearsal
from sher3_diagnosis.verdict import NextExperiment

SETTLED = 0.95
"""Share of the library's probability that one effect has once its rivals are told apart; below it its odds are open."""


def next_experiment(machine: Machine, finding: Finding) -> NextExperiment | None:
    """Propose an experiment for the first named cause whose odds are open; None when none are.

    Where the machine rehearses none, it is the excitation that shows the closest rival best, and nothing is foretold.
    """
    whole, named = finding.with_all, {term.key for term, _ in finding.attribution.named}
    judged = next((j for j in finding.judged if _open(j) and term_of(whole, j, 0).key in named), None)
    if judged is None:
        return None
    foretold = _foretold(machine, whole, judged)
    if foretold is not None:
        return foretold
    effects = [term_of(whole, judged, k).effect for k in sharing(judged)]
    ids = list(dict.fromkeys(effect.id for effect in effects))
    shows = next((e for e in effects if e.id != ids[0]), effects[0]).best
    return NextExperiment(excitation=shows.excitation, purpose=shows.why, separates=ids, predicted_separation=None)


def _foretold(machine: Machine, finding: Finding, judged: Judged) -> NextExperiment | None:
    """Return the experiment that promises most; what the recorded runs had not is added only where it is needed.

    That nothing tells two effects apart is known once every experiment was rehearsed. What goes nowhere new comes
    first where it settles one of the laws and that one stays more doubtful in the experiment that promises most: it
    shows no bend that nobody has seen, and what it leaves open is asked after it.
    """
    enough, rivals, groups = SETTLED * judged.library, Rivals.of(finding, judged), []
    rehearsals = machine.of(finding.evidence).rehearsals(finding.evidence, rivals.felt)
    alike = rivals.each
    for _, group in groupby(rehearsals, key=lambda x: (x.added, x.elsewhere)):
        groups.append([(x, rivals.prospect(x.data)) for x in group])
        if any(p.odds(alike) >= enough for _, p in groups[-1]):
            break
    else:
        alike = rivals.inseparable([p for tries in groups for _, p in tries])
    best: tuple[Rehearsal, Prospect] | None = None
    for tries in groups:
        likeliest = max(tries, key=lambda t: (min(t[1].odds(alike), enough), t[1].separation))
        if best is None or best[1].odds(alike) < min(enough, likeliest[1].odds(alike) - LISTED):
            best = likeliest
    if best is None:
        return None
    tried, promise = best[0], _promise(rivals, best[0])
    for known in (x for tries in groups for x, _ in tries if tried.elsewhere and not x.elsewhere):
        safe = _promise(rivals, known)
        each = zip(rivals.laws, safe.by_law(alike), promise.by_law(alike), strict=True)
        if sum(max(0.0, sure - risked) for law, sure, risked in each if sure >= enough * law.odds) > LISTED:
            tried, promise = known, safe
    keys = {k: term_of(finding, judged, k).key for k in sharing(judged)}
    one = rivals.one_answer(min(keys), alike)
    return NextExperiment(
        excitation=tried.excitation,
        purpose=tried.purpose,
        added=tried.added,
        separates=list(dict.fromkeys(effect for effect, _ in keys.values())),
        alike=[":".join(keys[k]) for k in sorted(one)] if len(one) > 1 else [],
        predicted_separation=promise.separation,
        expected_odds=promise.odds(alike),
    )


def _promise(rivals: Rivals, tried: Rehearsal) -> Prospect:
    """Return what an experiment makes of the odds on machines whose laws are bent where nobody has looked."""
    levels = LABELLED if tried.elsewhere else (0.0,)
    return rivals.prospect(tried.data, levels, tried.as_built() if tried.as_built else None)


def _open(j: Judged) -> bool:
    """Whether it is a cause of which no candidate has the odds of the library for itself."""
    return j.item.index is not None and max(j.effects) < SETTLED * j.library
