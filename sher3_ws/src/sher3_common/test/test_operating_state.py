"""The table of the operating state and the heartbeat's text."""

from __future__ import annotations

from itertools import product

import pytest
from sher3_common.operating_state import (
    TRANSITIONS,
    OperatingState,
    StateCommand,
    heartbeat_text,
    next_state,
    parse_heartbeat,
)
from sher3_common.reasons import Action


def test_fault_is_left_by_disable_alone():
    assert {command for state, command in TRANSITIONS if state is OperatingState.FAULT} == {StateCommand.DISABLE}
    assert next_state(OperatingState.FAULT, StateCommand.DISABLE) is OperatingState.DISABLED


def test_no_command_leads_into_fault():
    assert OperatingState.FAULT not in TRANSITIONS.values()


def test_a_pair_that_is_not_in_the_table_is_refused():
    assert next_state(OperatingState.PAUSED, StateCommand.ENABLE) is None


def test_words_equal_their_texts():
    assert OperatingState.ENABLED == "ENABLED" and StateCommand.ENABLE == "enable"


@pytest.mark.parametrize(("state", "action"), list(product(OperatingState, Action)))
def test_a_heartbeat_reads_back(state, action):
    assert parse_heartbeat(heartbeat_text(state, action)) == (state, action)


def test_the_heartbeats_text():
    assert heartbeat_text(OperatingState.FAULT, Action.POWER_OFF) == "FAULT POWER_OFF"


@pytest.mark.parametrize("text", ["", "ENABLED", "ENABLED 0", "enabled NONE", "RUNNING NONE", "ENABLED  NONE", "a b c"])
def test_a_damaged_heartbeat_is_none(text):
    assert parse_heartbeat(text) is None
