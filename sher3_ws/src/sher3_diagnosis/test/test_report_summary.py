"""The answer in words, for each status."""

import pytest
from sher3_diagnosis.judge.bets import placed
from sher3_diagnosis.report.summary import cause_text, closure_text, command, five_lines, headline
from sher3_diagnosis.reporter import Reporter
from sher3_diagnosis.verdict import (
    Answer,
    Cause,
    Closure,
    Interval,
    NextExperiment,
    Parameter,
    Place,
    Residual,
    Unexplained,
    Verdict,
    Where,
)


class Simulated(Reporter):
    simulated = True


class Into(Reporter):
    target = "--to mjcf --model arm.xml"


OURS = Simulated()
PLACE = Where(
    stage="transmission",
    actuator="tilt",
    gap=6e-6,
    floor=2e-6,
    unit="m",
    regime="just after a reversal",
    confidence=1.0,
)
FRICTION = Cause(
    effect="coulomb_friction",
    family="friction",
    stage="motor_mechanics",
    actuator="delta_2",
    parameters={"force": Parameter(value=0.3, low=0.25, high=0.35, unit="N")},
    closure=Interval(value=0.98, low=0.9, high=1.0),
)
BACKLASH = FRICTION.model_copy(
    update={"effect": "backlash", "actuator": "tilt", "parameters": {}, "rivals": ["transmission_compliance"]}
)
TELLS = NextExperiment(excitation="loads", purpose="", separates=["backlash", "cogging"], predicted_separation=None)
LEFT = Unexplained(stage="transmission", actuator="tilt", signature="largest at rest")


def verdict(status, **more):
    return Verdict(status=status, where=[PLACE], **more)


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (
            Verdict(status="no_gap", notes=["not judged, no motion: elbow"]),
            "No gap where it was judged: the machine does what its model says, to within its own repeatability; "
            "not judged, no motion: elbow.",
        ),
        (Verdict(status="no_gap"), "No gap: the machine does what its model says, to within its own repeatability."),
        (verdict("attributed", causes=[FRICTION]), "Coulomb friction on delta 2, 300 mN: 98 % of the gap."),
        (
            verdict("attributed", causes=[BACKLASH, FRICTION]),
            "Backlash on tilt and Coulomb friction on delta 2, 300 mN: 98 % of the gap.",
        ),
        (
            verdict("under_excited", causes=[FRICTION, BACKLASH], next_experiment=TELLS),
            "Backlash on tilt or transmission compliance: these runs cannot tell.",
        ),
        (
            verdict("outside_library", unexplained=LEFT),
            "No effect of the library explains the gap in transmission, tilt.",
        ),
        (
            verdict("outside_library", causes=[FRICTION], unexplained=LEFT),
            "Coulomb friction on delta 2, 300 mN: 98 % of the gap; no effect of the library explains the rest in "
            "transmission, tilt.",
        ),
        (
            verdict("outside_library", causes=[FRICTION], closure=Closure(stage=Interval(value=0.0)), unexplained=LEFT),
            "Coulomb friction on delta 2, 300 mN: 98 % of the gap there; no effect of the library explains the rest in "
            "transmission, tilt.",
        ),
    ],
)
def test_the_headline_is_the_answer(answer, text):
    assert headline(answer) == text


def test_five_lines_of_an_explained_gap():
    closed = Closure(stage=Interval(value=0.98, low=0.9, high=1.0), tip=Interval(value=0.5))
    left = Residual(gap=2.1e-6, floor=2e-6, unit="m")
    answer = verdict("attributed", causes=[FRICTION], closure=closed, residual=left)
    lines = dict(five_lines(answer, OURS, case="bags/case", folder="out"))
    assert list(lines) == ["verdict", "where", "cause", "closure", "next"]
    assert lines["where"] == "transmission, tilt: 6 µm rms, 3.0 times the floor, just after a reversal"
    assert lines["cause"] == "Coulomb friction on delta 2, force 300 mN (250 mN … 350 mN)"
    assert lines["closure"] == "stage 98 % (90 % … 100 %), at the tip 50 %, left 2.1 µm over a floor of 2 µm"
    assert lines["next"].startswith("`sher3 gap apply out/verdict.json -o corrected.yaml --case bags/case` ")


def test_commands_are_named_for_a_simulated_machine_only():
    answer = verdict("attributed", causes=[FRICTION])
    assert "own simulator" in dict(five_lines(answer, Reporter()))["next"]
    assert "verdict.json --to mjcf --model arm.xml`" in dict(five_lines(answer, Into()))["next"]
    open_one = verdict("under_excited", causes=[BACKLASH], next_experiment=TELLS)
    assert dict(five_lines(open_one, Reporter()))["next"] == "loads tells backlash / cogging apart"
    assert "`sher3 gap experiment" in dict(five_lines(open_one, OURS))["next"]
    foretold = TELLS.model_copy(update={"added": "a tracker at the tip", "expected_odds": 0.97})
    lines = dict(five_lines(open_one.model_copy(update={"next_experiment": foretold}), Reporter()))
    assert lines["next"] == "loads, with a tracker at the tip, tells backlash / cogging apart; expected odds 97 %"
    bet = Answer(causes=[BACKLASH], probability=0.5)
    hardly = {"next_experiment": foretold.model_copy(update={"expected_odds": 0.48}), "places": [placed(PLACE, [bet])]}
    assert "hardly tells backlash / cogging" in dict(five_lines(open_one.model_copy(update=hardly), Reporter()))["next"]


@pytest.mark.parametrize(("odds", "tried"), [(0.3, True), (0.05, False)])
def test_the_next_line_tries_a_bet_that_is_worth_it(odds, tried):
    outside = Answer(answer="outside_library", probability=1.0 - odds)
    bet = Answer(causes=[FRICTION], probability=odds, closure=Interval(value=0.97))
    answer = verdict("outside_library", places=[placed(PLACE, [outside, bet])], unexplained=LEFT)
    lines = {
        known: dict(five_lines(answer, OURS if known else Reporter(), case="bags/case"))["next"]
        for known in (True, False)
    }
    starts = ("`sher3 gap apply gap/bags/case/verdict.json -o corrected.yaml --case bags/case --bet` tries",
              "`sher3 gap export gap/bags/case/verdict.json --to yaml --bet` tries the best bet, 30 %")  # fmt: skip
    assert [lines[k].startswith(s) for k, s in zip((True, False), starts, strict=True)] == [tried, tried]
    assert tried or "sher3 gap discover" in lines[True]


def test_a_parameter_that_may_be_zero_is_not_told():
    unsure = Parameter(value=2.5e-6, low=-78e-6, high=83e-6, unit="m")
    sure = Parameter(value=-9.9e-3, low=-10.1e-3, high=-9.7e-3, unit="m")
    other = sure.model_copy(update={"low": -10.0e-3})
    cause = FRICTION.model_copy(update={"effect": "tool_offset", "parameters": {"x": unsure, "y": sure, "z": other}})
    assert cause_text(cause).count("-9.9 mm") == 2 and "2.5" not in cause_text(cause)
    assert headline(verdict("attributed", causes=[cause])) == "Tool offset on delta 2, -9.9 mm: 98 % of the gap."


def test_a_size_known_to_no_decade_is_not_told():
    force = FRICTION.parameters["force"]
    wide = Parameter(value=27.8e-9, low=80e-12, high=9.6e-6, unit="m")
    cause = FRICTION.model_copy(update={"parameters": {"displacement": wide, "force": force}})
    assert cause_text(cause) == "Coulomb friction on delta 2, force 300 mN (250 mN … 350 mN)"


def test_a_choice_is_told_by_its_word():
    """A scale that is of the whole sensor is not on "axis -1"."""
    axis = Parameter(value=-1.0, unit="1", means="all")
    relative = Parameter(value=0.05, low=0.04, high=0.06, unit="1")
    text = cause_text(FRICTION.model_copy(update={"parameters": {"relative": relative, "axis": axis}}))
    assert text.endswith(", axis all")


def test_what_one_number_tells_is_told_once_and_a_share_has_its_size():
    """A backlash whose flanks do not give loses just its width; a torque constant 14.6 % too large is so by 0.146."""
    wide = Parameter(value=1e-5, low=0.9e-5, high=1.1e-5, unit="m")
    backlash = FRICTION.model_copy(update={"effect": "backlash", "parameters": {"width": wide, "lost": wide}})
    assert cause_text(backlash) == "Backlash on delta 2, width 10 µm (9 µm … 11 µm)"


def test_a_size_of_nothing_is_not_told():
    at_once = FRICTION.model_copy(update={"parameters": {"displacement": Parameter(value=0.0, unit="m")}})
    assert "displacement" not in cause_text(at_once)
    choice = FRICTION.model_copy(update={"parameters": {"part": Parameter(value=0.0, unit="1")}})
    assert cause_text(choice).endswith("part 0")
    share = {"relative": Parameter(value=0.146, low=0.145, high=0.147, unit="1")}
    cause = FRICTION.model_copy(update={"effect": "torque_constant", "parameters": share})
    assert headline(verdict("attributed", causes=[cause])) == "Torque constant on delta 2, 14.6 %: 98 % of the gap."


def test_the_headline_says_what_the_rest_is():
    closed = {"closure": Closure(stage=Interval(value=0.95)), "residual": Residual(gap=4e-6, floor=2e-6, unit="m")}
    answer = verdict("attributed", causes=[BACKLASH], **closed)
    assert headline(answer) == "Backlash on tilt: 95 % of the gap; the rest is what its law leaves out."
    rests = {"backlash": "the elasticity of its contact"}
    assert headline(answer, rests).endswith("the rest is the elasticity of its contact.")


def left_at(actuator, closes, floors):
    """A place of an arm of which a cause closes a share and leaves some floors of 0.1 N m."""
    bet = Answer(
        causes=[FRICTION.model_copy(update={"actuator": actuator})],
        probability=0.99,
        closure=Interval(value=closes),
        residual=Residual(gap=0.1 * floors, floor=0.1, unit="N*m"),
    )
    rest = Answer(answer="outside_library", probability=0.01)
    where = {"stage": "motor_mechanics", "actuator": actuator, "gap": 2.0, "floor": 0.1, "unit": "N*m"}
    return Place(**where, answers=[bet, rest])


def test_the_headline_says_what_named_causes_do_not_explain():
    """Arms were attributed at 46 % of the gap of a joint, and nothing said so; a remainder near the floor is none."""
    places = [left_at("a", 0.97, 8.0), left_at("b", 0.46, 7.0), left_at("c", 0.8, 12.0), left_at("d", 0.6, 1.5)]
    said = headline(verdict("attributed", causes=[FRICTION], places=places))
    assert said.endswith("; not explained: 20 % at c (12.0 times its floor) and 54 % at b (7.0 times its floor).")
    assert "not explained" not in headline(verdict("attributed", causes=[FRICTION], places=places[:1]))


def test_the_command_goes_on_from_the_verdict():
    assert command(verdict("attributed", causes=[FRICTION]), OURS, "c")[0].startswith("sher3 gap apply gap/c/")
    assert command(verdict("outside_library", unexplained=LEFT), OURS, "c")[0].startswith("sher3 gap discover c ")
    assert command(verdict("attributed", causes=[FRICTION]), OURS, "c", "out")[0].startswith("sher3 gap apply out/")
    assert command(Verdict(status="no_gap"), OURS, "c") is None


def test_rivals_stand_behind_the_cause():
    assert cause_text(BACKLASH) == "Backlash on tilt [or transmission compliance]"
    vague = FRICTION.model_copy(update={"parameters": {"force": Parameter(value=0.3, low=-0.1, high=0.7, unit="N")}})
    assert cause_text(vague) == "Coulomb friction on delta 2, force 300 mN (-100 mN … 700 mN)"
    assert closure_text(Interval(value=0.997)) == "> 99 %"
