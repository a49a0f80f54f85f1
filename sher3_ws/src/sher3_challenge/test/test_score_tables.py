"""The tables of a challenge: what they print of a rate, and which cases count as missed."""

from io import StringIO

from rich.console import Console
from sher3_challenge.score.case import CaseScore
from sher3_challenge.score.outcome import Outcome
from sher3_challenge.score.rates import Rate, Summary
from sher3_challenge.score.tables import confusion_table, misses_table, rates_table


def row(case, truth, said, **more):
    return CaseScore(case, truth, said, "backlash", "lead_error", "lost_motion", "scale", **more)


def printed(table):
    console = Console(width=120, file=StringIO())
    console.print(table)
    return console.file.getvalue()


def test_a_rate_is_printed_with_its_number_and_interval():
    summary = Summary({"stage": Rate(0.5, 4, 0.15, 0.85), "seconds": Rate(None, 0)}, {}, {})
    text = printed(rates_table("rates", {"diagnosis": summary, "best_rmse": summary}))
    assert "0.500 0.15-0.85 (n 4)" in text and ">= 0.95" in text and "0.50 " in text


def test_misses_are_wrong_answers_from_three_floors_on():
    rows = [
        row("right", "attributed", "attributed", gap_over_floor=5.0, stage=True, actuator=True, in_set=True),
        row("wrong_stage", "attributed", "attributed", gap_over_floor=5.0, stage=False, actuator=True, in_set=True),
        row("near_the_floor", "attributed", "no_gap", gap_over_floor=2.9),
        row("false_alarm", "no_gap", "attributed"),
        row("not_in_set", "attributed", "attributed", gap_over_floor=3.0, stage=True, actuator=True, in_set=False),
    ]
    text = printed(misses_table(Outcome({"diagnosis": rows}, 1.0, (0, 5), {})))
    assert all(name in text for name in ("wrong_stage", "false_alarm", "not_in_set"))
    assert "right" not in text.replace("wrong", "") and "near_the_floor" not in text


def test_confusions_count_each_pair():
    text = printed(confusion_table("status", {"no_gap": {"no_gap": 3, "attributed": 1}}))
    assert "3" in text and "1" in text and "attributed" in text
