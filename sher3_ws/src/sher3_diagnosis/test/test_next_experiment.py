"""Which experiment is proposed for rivals, and the odds that it promises."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.judge.experiments.prediction import predicted
from sher3_diagnosis.machine import Rehearsal
from toy import DIRECTION, Column, Toy, case, evidence_of, stroke

WARMTH = Column("warmth", "drift", "warmth")
"""Follows the warmth, which here goes with the direction."""


def warmed(run, share):
    """Return a run of which the warmth is the direction in a share of the samples, and nothing in the others."""
    follows = np.where(np.arange(len(run.values)) < share * len(run.values), np.sign(run.velocity), 0.0)
    return replace(run, warmth=follows)


@dataclass(frozen=True)
class Foreseeing(Toy):
    """A toy that foresees more of the same, and then what is different."""

    effects_known: tuple = (DIRECTION, WARMTH)
    different: str = ""
    elsewhere: bool = True

    def rehearsals(self, evidence, felt):
        empty = stroke(size=0.0)
        quiet = replace(empty, values=np.zeros_like(empty.values))
        yield Rehearsal("same", "more of the same", "", evidence_of([warmed(quiet, 1.0)]).data)
        yield Rehearsal(
            "apart", "no warmth", self.different, evidence_of([warmed(quiet, 0.0)] * 2).data, self.elsewhere
        )


@pytest.fixture
def alike():
    return [warmed(run, 1.0) for run in case(5.0)]


def test_an_experiment_in_which_the_rivals_differ_is_expected_to_settle_them(alike):
    verdict = diagnose(Foreseeing(), alike).verdict
    assert verdict.status == "under_excited"
    assert verdict.causes[0].probability == pytest.approx(0.5, abs=0.02)
    asked = verdict.next_experiment
    assert (asked.excitation, asked.purpose, asked.added) == ("apart", "no warmth", "")
    assert asked.expected_odds > 0.95
    assert asked.predicted_separation > 1.0


def test_what_the_recorded_runs_had_not_is_added_where_they_tell_nothing(alike):
    assert diagnose(Foreseeing(different="a second sensor"), alike).verdict.next_experiment.added == "a second sensor"


def test_rivals_that_no_experiment_tells_apart_are_one_answer(alike):
    class Same(Foreseeing):
        def rehearsals(self, evidence, felt):
            yield next(super().rehearsals(evidence, felt))

    verdict = diagnose(Same(), alike).verdict
    asked, answers = verdict.next_experiment, verdict.places[0].answers
    assert asked.alike == [f"{a.causes[0].effect}:axis" for a in answers if a.causes]
    assert verdict.one_answer == answers[:2]
    assert 0.95 < asked.expected_odds <= sum(a.probability for a in verdict.one_answer)
    assert asked.predicted_separation == pytest.approx(0.0, abs=1e-6)
    assert verdict.unseparated_rivals == asked.separates
    told = diagnose(Foreseeing(), alike).verdict
    assert (told.one_answer, told.unseparated_rivals) == ([], [])


def test_the_odds_that_the_library_lacks_the_cause_stay_as_they_are(alike):
    verdict = diagnose(Foreseeing(), alike).verdict
    library = sum(a.probability for a in verdict.places[0].answers if a.causes)
    assert verdict.next_experiment.expected_odds <= library


def test_less_is_promised_where_a_law_may_be_bent_as_nobody_has_seen(alike):
    bent, seen = (diagnose(Foreseeing(elsewhere=x), alike).verdict for x in (True, False))
    library = sum(a.probability for a in seen.places[0].answers if a.causes)
    assert seen.next_experiment.expected_odds == pytest.approx(library, abs=1e-3)
    assert 0.95 < bent.next_experiment.expected_odds < library - 0.005


class Elsewhere(Column):
    """Follows the warmth, but for the experiment that goes far."""

    def signature(self, view, site, shape):
        other = Column("other", "drift", "one" if view.excitation == "far" else "warmth")
        return other.signature(view, site, {})


@dataclass(frozen=True)
class GoingFar(Foreseeing):
    """A toy whose direction is told where it was recorded, and the two others only far from there."""

    effects_known: tuple = (DIRECTION, WARMTH, Elsewhere("elsewhere", "drift", "warmth"))

    def rehearsals(self, evidence, felt):
        empty = stroke(size=0.0)
        quiet = warmed(replace(empty, values=np.zeros_like(empty.values)), 0.5)
        far = replace(quiet, excitation="far")
        yield Rehearsal("known", "half as warm", "", evidence_of([quiet] * 2).data, elsewhere=False)
        yield Rehearsal("far", "and far", "", evidence_of([far] * 12).data, elsewhere=self.elsewhere)


@pytest.mark.parametrize(("elsewhere", "first"), [(True, "known"), (False, "far")])
def test_what_goes_nowhere_new_comes_first_where_it_settles_a_law(alike, elsewhere, first):
    """Far away a bend may show that nobody has seen; of three laws the known place tells one, and the far one all."""
    asked = diagnose(GoingFar(elsewhere=elsewhere), alike).verdict.next_experiment
    assert asked.excitation == first
    assert asked.expected_odds == pytest.approx(2 / 3 if elsewhere else 1.0, abs=0.02)


class Formed(Column):
    """Follows the warmth, or in its other form the direction."""

    def shapes(self, views, site):
        return [{"form": 0.0}, {"form": 1.0}]

    def signature(self, view, site, shape):
        other = Column("other", "drift", "direction" if shape.get("form") else "warmth")
        return other.signature(view, site, {})


def test_each_form_of_a_law_that_is_left_open_may_be_at_work_and_may_stand_in(alike):
    """The direction looks like the drift of its form then, and both are one answer; of its other form it is told."""
    formed = Foreseeing(effects_known=(DIRECTION, Formed("drift", "drift", "warmth")), elsewhere=False)
    asked = diagnose(formed, alike).verdict.next_experiment
    assert asked.expected_odds > 0.95  # settled
    assert asked.alike == []  # as long as the other form may be at work


def test_a_bend_is_a_share_of_the_power_of_the_last_law(alike):
    evidence = evidence_of(alike)
    terms = [make_term(evidence.data, x, "axis", {}) for x in (DIRECTION, WARMTH)]
    found = fit(evidence.data, terms[:1])
    plain, bent = (predicted(found, terms[:1], evidence.data, level) for level in (0.0, 0.1))
    straight, off = (np.concatenate([y for run in x for y in run.values()]) for x in (plain, bent))
    assert np.mean((off - straight) ** 2) == pytest.approx(0.1 * np.mean(straight**2), rel=0.3)


def test_deviations_that_only_further_runs_show_may_be_what_tells_the_rivals_apart(alike):
    """Where the machine may rub there by itself, the run without warmth tells no drift from a direction."""

    class Rubbing(Foreseeing):
        def rehearsals(self, evidence, felt):
            for tried in super().rehearsals(evidence, felt):
                both = evidence.data.with_runs(tried.data, tried.data.target)
                free = make_term(both, DIRECTION, "axis", {})
                quiet = [{c: 0.0 * x for c, x in run.items()} for run in free.columns[: len(evidence.data.views)]]
                columns = quiet + free.columns[len(quiet) :]
                yield tried._replace(as_built=lambda columns=columns, free=free: [replace(free, columns=columns)])

    told, free = (diagnose(x(elsewhere=False), alike).verdict.next_experiment for x in (Foreseeing, Rubbing))
    assert told.expected_odds > 0.95
    assert free.expected_odds < 0.7


def test_a_machine_is_told_what_the_rivals_depend_on(alike):
    """A page that does not say what its law depends on would never be told by what changes that alone."""

    class Asked(Foreseeing):
        def rehearsals(self, evidence, felt):
            told.append(set(felt))
            yield from super().rehearsals(evidence, felt)

    told = []
    pages = (Column("direction", "d", "direction", inputs=("direction",)), Column("w", "w", "warmth", inputs=("time",)))
    diagnose(Asked(effects_known=pages), alike)
    assert told == [{"direction", "time"}]


def test_a_machine_that_foresees_nothing_names_what_shows_the_rival(alike):
    asked = diagnose(Toy((DIRECTION, WARMTH)), alike).verdict.next_experiment
    assert (asked.excitation, asked.expected_odds) == ("steps", None)
