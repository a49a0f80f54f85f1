"""What the terminal tells, from the statuses of a run, without ROS and without a terminal."""

import io

import pytest
from sher3_bringup.terminal.screen import Screen
from sher3_bringup.terminal.status_news import StatusNews
from sher3_common.reasons import Reason
from sher3_common.remedies import REMEDY, remedy

STOP = {"code": "EMERGENCY_STOP", "value": 1.0, "limit": 0.0, "unit": "1", "source": "pedal/measured"}
FAULT = {"state": "FAULT", "since": 3, "reason": "EMERGENCY_STOP", "first_fault": STOP, "refused": None}
ENABLED = {"state": "ENABLED", "since": 2, "reason": "enable", "first_fault": None, "refused": None}
DISABLED = {**ENABLED, "state": "DISABLED", "since": 4, "reason": "disable"}


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_change_of_state_is_one_line_with_reason_and_remedy_and_is_said_once():
    news = StatusNews()
    assert news.hear("supervisor/status", ENABLED) == ["ENABLED  by enable"]
    assert news.hear("supervisor/status", ENABLED) == []
    (line,) = news.hear("supervisor/status", FAULT)
    assert line == (
        "FAULT  EMERGENCY_STOP pedal/measured: 1 1, limit 0 1; the emergency stop is pressed; "
        "release the emergency stop, then send disable, and enable"
    )
    assert news.fault == line
    assert news.hear("supervisor/status", {**FAULT, "later_faults": 1}) == []


def test_a_recovered_fault_is_none_at_the_end_and_a_second_one_is_said_again():
    news = StatusNews()
    for status in (FAULT, DISABLED):
        news.hear("supervisor/status", status)
    assert news.fault == ""
    assert len(news.hear("supervisor/status", {**FAULT, "since": 9})) == 1 and news.fault


def test_a_pause_says_how_it_ends():
    overrun = {"code": "OVERRUN", "value": 0.3, "limit": 0.1, "unit": "of the cycles", "source": "sher3/admittance"}
    (line,) = StatusNews().hear("supervisor/status", {**FAULT, "state": "PAUSED", "first_fault": overrun})
    assert line.startswith("PAUSED  OVERRUN") and line.endswith("then send resume")


def test_a_refusal_is_said_once_and_again_after_it_was_settled():
    news, refused = StatusNews(), {"mode": None, "refused": {"text": "move_jp rejected: joint names differ"}}
    news.hear("motion/status", {"mode": None, "refused": None})
    assert news.hear("motion/status", refused) == ["refused  move_jp rejected: joint names differ"]
    assert news.hear("motion/status", refused) == []
    assert news.hear("motion/status", {"mode": None, "refused": None}) == []
    assert len(news.hear("motion/status", refused)) == 1


def test_what_was_refused_before_is_not_said():
    news = StatusNews()
    assert news.hear("motion/status", {"mode": None, "refused": {"text": "of another client"}}) == []
    assert news.hear("motion/status", {"mode": None, "refused": {"text": "mine"}}) == ["refused  mine"]


def test_an_enabled_robot_that_does_not_follow_says_why_once():
    news, frozen = StatusNews(), {"reason": "WRENCH_FROZEN", "text": "the wrench repeats bit for bit", "since": 5}
    assert news.hear("admittance/status", frozen) == news.hear("admittance/status", frozen) == []
    news.hear("supervisor/status", ENABLED)
    (line,) = news.hear("admittance/status", frozen)
    assert line.startswith("at rest  WRENCH_FROZEN: the wrench repeats bit for bit; ") and "add noise" in line
    for status in (frozen, {**frozen, "since": 6}, {**frozen, "since": 6}):
        assert news.hear("admittance/status", status) == []


def test_what_lasts_no_second_and_a_released_pedal_are_no_reasons_to_say_so():
    news = StatusNews()
    news.hear("supervisor/status", ENABLED)
    for status in (("WRENCH_FROZEN", 5), ("MOVING", 6), ("WRENCH_FROZEN", 7), *[("PEDAL_RELEASED", 8)] * 3):
        assert news.hear("admittance/status", dict(zip(("reason", "since"), status, strict=True))) == []


def test_the_status_line_has_state_mode_force_speed_and_lost_cycles():
    news = StatusNews()
    news.hear("supervisor/status", ENABLED)
    news.hear("admittance/status", {"text": "the pedal is released"})
    assert news.status() == "ENABLED   the pedal is released   lost cycles 0"
    news.hear("motion/status", {"mode": "cooperative"})
    news.hear("diagnostics", {"name": "admittance: inputs", "values": (("force [N]", "0.934"),)})
    news.hear("diagnostics", {"name": "kinematics: inputs", "values": (("TIP_SPEED tip [m/s]", "0.00083 limit 1"),)})
    for node, lost in (("sher3/admittance", "2"), ("sher3/pedal", "1"), ("sher3/pedal", "3")):
        news.hear("diagnostics", {"name": node, "values": (("lost_cycles", lost),)})
    assert news.status() == "ENABLED   cooperative   force 0.93 N   tip 0.83 mm/s   lost cycles 5"


def test_every_reason_has_a_remedy_and_a_second_publisher_is_told_what_to_start():
    assert set(REMEDY) == set(Reason)
    assert "--without pedal" in remedy(Reason.PUBLISHED_TWICE, "pedal/measured")
    assert "noise" in remedy(Reason.WRENCH_FROZEN)


def test_colour_and_status_line_are_for_terminals_alone(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    pipe, terminal = io.StringIO(), Terminal()
    for screen in (Screen(pipe), Screen(terminal)):
        screen.status("ENABLED   lost cycles 0")
        screen("1.0 s  FAULT  why")
        screen.status("")
    assert pipe.getvalue() == "1.0 s  FAULT  why\n"
    assert "\x1b[31mFAULT\x1b[0m  why\n\rENABLED   lost cycles 0" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\x1b[K")


@pytest.mark.parametrize("value", ["1", ""])
def test_no_color_is_kept(monkeypatch, value):
    monkeypatch.setenv("NO_COLOR", value)
    Screen(terminal := Terminal())("FAULT")
    assert ("\x1b[31m" in terminal.getvalue()) == (value == "")
