"""Bets: probabilities that add up to one, by hand and on the toy machine, the best explanation kept."""

import pytest
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Candidate, ExactFinding, Item, Judged
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.judge.bets import NONE, exact_place, placed, shares
from sher3_diagnosis.judge.probabilities import first_place_odds
from sher3_diagnosis.report.odds import answered, odds, sizes
from sher3_diagnosis.report.summary import five_lines
from sher3_diagnosis.reporter import Reporter
from sher3_diagnosis.verdict import Answer, Cause, Interval, NextExperiment, Parameter, Residual, Verdict, Where
from toy import DIRECTION, Column, Toy, case

WHERE = Where(stage="transport", actuator="all", gap=1e-3, floor=1e-9, unit="m/s", regime="", confidence=1.0)
LEFT = Residual(gap=1e-9, floor=1e-9, unit="m/s")


def cause(effect="command_delay", closes=0.97):
    return Cause(
        effect=effect, family="timing", stage="transport", actuator="all", parameters={}, closure=Interval(value=closes)
    )


def item(*effects, outside=0.0, no_gap=0.0):
    found = [Candidate(f"e{k}", "tilt", "friction", (), float(k)) for k in range(len(effects))]
    return Judged(Item(Channel("drive", "tilt"), 0, {}, found), effects, outside, no_gap)


def total(place):
    return place.other + sum(a.probability for a in place.answers)


def test_two_causes_of_one_place_by_hand():
    """0.6 and 0.3 for the first's effects, 0.1 none; 0.8 for the second's, 0.2 none: 0.9 * 0.8 and so on."""
    both = dict(shares([item(0.6, 0.3, no_gap=0.1), item(0.8, no_gap=0.2)]))
    assert both[0, 0] == pytest.approx(0.48)
    assert both[1, 0] == pytest.approx(0.24)
    assert both[0, NONE] == pytest.approx(0.12)
    assert both[NONE, 0] == pytest.approx(0.08)
    assert (NONE, NONE) not in both
    assert sum(both.values()) == pytest.approx(1.0 - 0.1 * 0.2)


def test_what_two_causes_leave_is_doubted_once():
    """0.4 and 0.3 for a foreign law: the remainder is one, and its odds are 0.4, not 1 - 0.6 * 0.7."""
    both = dict(shares([item(0.6, outside=0.4), item(0.5, 0.2, outside=0.3)]))
    assert both == pytest.approx({(0, 0): 0.6 * 5 / 7, (0, 1): 0.6 * 2 / 7})


def test_the_best_explanation_is_listed_however_improbable_and_the_rest_is_counted():
    answers = [Answer(answer="outside_library", probability=0.994), Answer(causes=[cause()], probability=0.003)]
    found = placed(WHERE, [*answers, Answer(causes=[cause("axis_skew")], probability=0.002)])
    assert [a.probability for a in found.answers] == [0.994, 0.003]
    assert found.bet.causes[0].effect == "command_delay"
    assert total(found) == pytest.approx(1.0)


def test_an_exact_stage_without_causes_is_outside():
    stage = ExactFinding(WHERE, [], Interval(value=0.0), LEFT)
    assert [a.answer for a in exact_place(stage, 0.0).answers] == ["outside_library"]
    known = exact_place(ExactFinding(WHERE, [cause()], Interval(value=0.97), LEFT), 0.9)
    assert first_place_odds([known]) == pytest.approx({"command_delay:all": 0.9, "outside_library": 0.1})
    assert first_place_odds([]) == {"no_gap": 1.0}


@pytest.mark.parametrize("size, without", [(5.0, ()), (5.0, ("direction",)), (5.0, ("direction", "speed")), (0.0, ())])
def test_on_every_machine_what_one_would_bet_adds_up_to_one(size, without):
    twin = Column("twin", "inertia", "direction")
    verdict = diagnose(Toy((DIRECTION, twin)) if not without else Toy(), case(size), without).verdict
    assert len(verdict.places) >= len(verdict.where)
    for place in verdict.places:
        assert total(place) == pytest.approx(1.0)
        assert place.answers == sorted(place.answers, key=lambda a: -a.probability)
    named = {c.effect for c in verdict.causes}
    assert named <= {c.effect for p in verdict.places for a in p.answers for c in a.causes}
    assert sum(verdict.probabilities.values()) == pytest.approx(1.0, abs=0.05)


def spoken(*answers, status="outside_library"):
    place = placed(WHERE, answers)
    verdict = Verdict.model_construct(status=status, places=[place], costs={"name": 1.0}, causes=[])
    return odds(verdict)


def test_the_headline_speaks_the_odds():
    bet = Answer(causes=[cause()], probability=0.4988, closure=Interval(value=0.97))
    lacks = Answer(answer="outside_library", probability=0.5005)
    text = spoken(bet, lacks)
    assert text == "command delay on all axes, 50 %: closes 97 %; or something like it that the library lacks, 50 %"
    rare = bet.model_copy(update={"probability": 0.07})
    text = spoken(rare, lacks.model_copy(update={"probability": 0.93}))
    assert text.startswith("something that the library lacks in transport, all axes, 93 %; or command delay on all")
    sure = bet.model_copy(update={"probability": 0.99})
    assert spoken(sure, lacks.model_copy(update={"probability": 0.01}), status="attributed") == ""
    assert spoken(rare.model_copy(update={"probability": 0.01}), lacks) == ""


def test_what_nothing_tells_apart_is_spoken_of_as_one():
    weight, mass = (
        Answer(causes=[cause(x)], probability=p) for x, p in (("gravity_load", 0.47), ("payload_mass", 0.46))
    )
    lacks = Answer(answer="outside_library", probability=0.07)
    alike = ["gravity_load:all", "payload_mass:all"]
    tells = NextExperiment(excitation="steps", purpose="", separates=[], predicted_separation=0.0, alike=alike)
    more = {"status": "attributed", "causes": [*weight.causes], "costs": {"name": 1.0}, "next_experiment": tells}
    verdict = Verdict.model_construct(places=[placed(WHERE, [weight, mass, lacks])], **more)
    said = "gravity load on all axes or payload mass on all axes (the same data), 93 %"
    assert odds(verdict) == f"{said}; or something like it that the library lacks, 7 %"
    tells = tells.model_copy(update={"separates": ["gravity_load", "payload_mass"]})
    lines = dict(five_lines(verdict.model_copy(update={"next_experiment": tells, "where": [WHERE]}), Reporter()))
    assert lines["next"] == "no experiment that was rehearsed tells gravity load / payload mass apart"


def test_an_answer_is_its_causes_and_the_sizes_that_are_told():
    told = Parameter(value=2e-3, low=1e-3, high=3e-3, unit="s")
    late = cause().model_copy(update={"parameters": {"delay": told, "skew": told.model_copy(update={"low": -1e-3})}})
    assert answered(Answer(causes=[late], probability=0.5)) == "Command delay on all axes"
    assert sizes(Answer(causes=[late], probability=0.5)) == "delay 2 ms (1 ms … 3 ms)"
    assert answered(Answer(answer="no_gap", probability=0.5)) == "No gap"
