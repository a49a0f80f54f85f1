"""A verdict that abstains, taken at its best bets."""

import pytest
from sher3_diagnosis.bet import NoBetError, bets_text, betting
from sher3_diagnosis.verdict import Answer, Cause, Interval, Parameter, Place, Unexplained, Verdict, Where

WHERE = {"stage": "transmission", "actuator": "roll", "gap": 9.0, "floor": 1.0, "unit": "rad"}
NONE = Answer(answer="no_gap", probability=1.0)


def cause(effect="transmission_compliance", rivals=()):
    parameters = {"stiffness": Parameter(value=266.0, unit="N*m/rad")}
    return Cause(
        effect=effect, family="compliance", stage="transmission", actuator="roll", parameters=parameters,
        closure=Interval(value=0.88), rivals=list(rivals),
    )  # fmt: skip


def abstaining(*places):
    return Verdict(
        status="outside_library",
        where=[Where(**WHERE, regime="everywhere", confidence=1.0)],
        places=list(places),
        unexplained=Unexplained(stage="transmission", actuator="roll", signature="largest everywhere"),
    )


LACKS = Answer(answer="outside_library", probability=0.9)
BET = Answer(causes=[cause()], probability=0.07, closure=Interval(value=0.88))
OTHER = Answer(causes=[cause("backlash")], probability=0.03)


def test_the_best_bet_takes_the_place_of_the_causes_and_keeps_its_rivals():
    taken = betting(abstaining(Place(**WHERE, answers=[LACKS, BET, OTHER])))
    assert (taken.status, taken.unexplained, taken.closure.stage.value) == ("attributed", None, 0.88)
    assert [(c.effect, c.rivals) for c in taken.causes] == [("transmission_compliance", ["backlash"])]
    own = BET.model_copy(update={"causes": [cause(rivals=["lead_error"])]})
    assert betting(abstaining(Place(**WHERE, answers=[LACKS, own, OTHER]))).causes[0].rivals == ["lead_error"]


def test_a_cause_of_two_places_is_taken_once_and_a_likely_echo_is_no_bet():
    here = Place(**WHERE, answers=[LACKS, BET, OTHER])
    there = Place(**{**WHERE, "stage": "motor_mechanics"}, answers=[LACKS, BET, OTHER])
    echo = Place(**{**WHERE, "stage": "drive"}, answers=[NONE, OTHER.model_copy(update={"probability": 0.0})])
    verdict = abstaining(here, there, echo)
    assert [c.effect for c in betting(verdict).causes] == ["transmission_compliance"]
    assert bets_text(verdict)[0] == "transmission, roll: transmission compliance on roll, 7 %, closes 88 %"
    assert len(bets_text(verdict)) == 2


def test_where_nothing_closes_a_gap_there_is_no_bet():
    with pytest.raises(NoBetError, match="lists no effect to bet on") as refused:
        betting(abstaining(Place(**WHERE, answers=[LACKS], other=0.1)))
    assert "discover" in refused.value.remedy
    with pytest.raises(NoBetError) as refused:
        betting(abstaining())
    assert "again" in refused.value.remedy
