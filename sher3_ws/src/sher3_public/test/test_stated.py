"""What was guessed wrongly is put right by keywords, with arrays as they are."""

import re

import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import asked, drawn_xml, logged

SEED, LATE = 704, 5
XML = drawn_xml(np.random.default_rng(SEED))
"""An arm of three joints, `implicit`, as its model says."""


@pytest.fixture(scope="module")
def log():
    return logged(XML, SEED)


def healthy(model, log, control, position=None, time=None, **stated):
    time = log.time if time is None else time
    return gap.diagnose(model, time, control, log.qpos if position is None else position, **stated).status == "no_gap"


def test_units_of_arrays(log):
    units = {"time": "ms", "position": "deg", "control": "degrees"}
    assert healthy(XML, log, np.degrees(log.ctrl), np.degrees(log.qpos), 1e3 * log.time, units=units)


def test_which_control_drives_which_joint(log):
    assert healthy(XML, log, log.ctrl[:, ::-1], controls=["elbow", "shoulder", "turn"])


def test_a_delay_that_no_model_states(log):
    early = np.vstack([log.ctrl[LATE:], np.repeat(log.ctrl[-1:], LATE, axis=0)])
    assert healthy(XML, log, early, delay=LATE * 0.001)


MOTORS = re.sub(r'<position joint="(\w+)" [^>]*/>', r'<motor joint="\1"/>', XML)
"""The same arm with motors, as people have it."""
LAWS = {name: (300.0 * 0.5**i, 15.0 * 0.5**i) for i, name in enumerate(("turn", "shoulder", "elbow"))}
"""Gains of the firmware that drives its motors in `logged`: of the place, and of the speed."""


@pytest.fixture(scope="module")
def firmware():
    """A log of motors, and the places (n, 3) that their firmware was asked for."""
    log = logged(MOTORS, SEED)
    return log, asked(np.random.default_rng(SEED), log.time, len(LAWS))


def test_servos_whose_law_is_in_the_firmware(firmware):
    log, places = firmware
    assert healthy(MOTORS, log, places, servo=LAWS)


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ({"units": {"position": "N"}}, "unit of position"),
        ({"units": {"places": "deg"}}, "no such array"),
        ({"controls": ["elbow"]}, "controls do not fit"),
        ({"controls": ["elbow", "elbow", "turn"]}, "controls do not fit"),
        ({"servo": {"nobody": (1.0, 2.0)}}, "servo of no such joint"),
        ({"gain": {"nobody": 1.0}}, "gain of no such joint"),
        ({"delay": {"nobody": 1.0}}, "delay of no such joint"),
        ({"delay": -1.0}, "below zero"),
    ],
)
def test_what_cannot_be_stated_is_said(log, stated, words):
    with pytest.raises(gap.InputError, match=words):
        gap.diagnose(XML, log.time, log.ctrl, log.qpos, **stated)


def table(log, scale=1.0):
    return {"time": log.time, "ctrl": scale * log.ctrl, "qpos": scale * log.qpos}


def test_units_of_a_table(log):
    degrees = table(log, np.degrees(1.0))
    assert gap.diagnose(XML, degrees, units={"position": "deg", "control": "deg"}).status == "no_gap"


def test_a_delay_of_a_table(log):
    early = np.vstack([log.ctrl[LATE:], np.repeat(log.ctrl[-1:], LATE, axis=0)])
    assert gap.diagnose(XML, {**table(log), "ctrl": early}, delay=LATE * 0.001).status == "no_gap"


def test_the_gains_of_servos_of_a_table(firmware):
    log, places = firmware
    assert gap.diagnose(MOTORS, {**table(log), "ctrl": places}, servo=LAWS).status == "no_gap"


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ({"joints": ["a", "b", "c"]}, "by that which joint"),
        ({"units": {"position": "ells"}}, "unit of position"),
        ({"delay": {"nobody": 0.01}}, "delay of no such joint"),
        ({"servo": {"nobody": (1.0, 1.0)}}, "servo of no such joint"),
    ],
)
def test_what_cannot_be_stated_of_a_table_is_said(log, stated, words):
    with pytest.raises(gap.InputError, match=words):
        gap.diagnose(XML, table(log), **stated)
