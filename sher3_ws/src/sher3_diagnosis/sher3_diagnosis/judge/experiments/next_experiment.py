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
    effects = [term_of(whole, judged, k).effect for k in sharing(judged)]
    ids = list(dict.fromkeys(effect.id for effect in effects))
    best = best_of(machine, whole, judged)
    if best is None:
        shows = next((e for e in effects if e.id != ids[0]), effects[0]).best
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
    rivals = Rivals.of(finding, judged)
    rehearsals = machine.of(finding.evidence).rehearsals(finding.evidence)
    for _, tries in groupby(rehearsals, key=lambda x: (x.added, x.elsewhere)):
        prospects = [(x, rivals.prospect(x.data)) for x in tries]
        likeliest = max(prospects, key=lambda t: (min(t[1].odds, enough), t[1].separation))
        if best is None or likeliest[1].odds > best[1].odds + LISTED:
            best = likeliest
        if best[1].odds >= enough:
            break
    if best is None:
        return None
    chosen, _ = best
    levels = LABELLED if chosen.elsewhere else (0.0,)
    return chosen, rivals.prospect(chosen.data, levels, chosen.as_built and chosen.as_built())


def _open(j: Judged) -> bool:
    """Whether it is a cause of which no candidate has the odds of the library for itself."""
    return j.item.index is not None and max(j.effects) < SETTLED * j.library
