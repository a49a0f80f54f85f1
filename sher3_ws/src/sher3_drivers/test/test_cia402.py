"""The CiA 402 table, exhaustively."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_drivers.canopen.cia402 import (
    TRANSITIONS,
    Controlword,
    DriveState,
    Goal,
    decode_status,
    next_command,
    transition,
)
from sher3_drivers.errors import UnknownStatusword

S, C = DriveState, Controlword

# The automaton of CiA 402-2 written down a second time, state by state, from the standard's figure.
FIGURE = {
    S.NOT_READY_TO_SWITCH_ON: {},
    S.SWITCH_ON_DISABLED: {C.SHUTDOWN: S.READY_TO_SWITCH_ON},
    S.READY_TO_SWITCH_ON: {
        C.SWITCH_ON: S.SWITCHED_ON,
        C.ENABLE_OPERATION: S.SWITCHED_ON,
        C.DISABLE_VOLTAGE: S.SWITCH_ON_DISABLED,
        C.QUICK_STOP: S.SWITCH_ON_DISABLED,
    },
    S.SWITCHED_ON: {
        C.ENABLE_OPERATION: S.OPERATION_ENABLED,
        C.SHUTDOWN: S.READY_TO_SWITCH_ON,
        C.DISABLE_VOLTAGE: S.SWITCH_ON_DISABLED,
        C.QUICK_STOP: S.SWITCH_ON_DISABLED,
    },
    S.OPERATION_ENABLED: {
        C.SWITCH_ON: S.SWITCHED_ON,
        C.SHUTDOWN: S.READY_TO_SWITCH_ON,
        C.DISABLE_VOLTAGE: S.SWITCH_ON_DISABLED,
        C.QUICK_STOP: S.QUICK_STOP_ACTIVE,
    },
    S.QUICK_STOP_ACTIVE: {C.DISABLE_VOLTAGE: S.SWITCH_ON_DISABLED},
    S.FAULT_REACTION_ACTIVE: {},
    S.FAULT: {C.FAULT_RESET: S.SWITCH_ON_DISABLED},
}


@pytest.mark.parametrize(("state", "command"), list(itertools.product(DriveState, Controlword)))
def test_every_state_and_command(state, command):
    assert transition(state, command) is FIGURE[state].get(command, state)


def test_the_table_has_nothing_else():
    assert len(TRANSITIONS) == sum(len(row) for row in FIGURE.values())


@given(st.integers(0, 0xFFFF))
def test_every_statusword_is_one_state_or_refused(word):
    matches = [state for state in DriveState if word & state.value[0] == state.value[1]]
    if matches:
        assert [decode_status(word)] == matches
    else:
        with pytest.raises(UnknownStatusword):
            decode_status(word)


@pytest.mark.parametrize(
    ("word", "state"),
    [
        (0x0250, S.SWITCH_ON_DISABLED),
        (0x0231, S.READY_TO_SWITCH_ON),
        (0x0233, S.SWITCHED_ON),
        (0x1237, S.OPERATION_ENABLED),
        (0x0217, S.QUICK_STOP_ACTIVE),
        (0x0218, S.FAULT),
        (0x021F, S.FAULT_REACTION_ACTIVE),
        (0x0200, S.NOT_READY_TO_SWITCH_ON),
    ],
)
def test_statuswords_of_real_drives(word, state):
    assert decode_status(word) is state


def reach(state, goal):
    seen = [state]
    while (after := transition(seen[-1], next_command(seen[-1], goal))) not in seen:
        seen.append(after)
    return seen


def test_enabling_takes_three_steps():
    assert reach(S.SWITCH_ON_DISABLED, Goal.ENABLED) == [
        S.SWITCH_ON_DISABLED,
        S.READY_TO_SWITCH_ON,
        S.SWITCHED_ON,
        S.OPERATION_ENABLED,
    ]


@pytest.mark.parametrize("state", list(DriveState))
def test_no_goal_leaves_a_fault_or_resumes_from_a_stop(state):
    for goal in Goal:
        path = reach(state, goal)
        assert C.FAULT_RESET not in [next_command(s, goal) for s in path]
        if state in (S.FAULT, S.FAULT_REACTION_ACTIVE, S.NOT_READY_TO_SWITCH_ON):
            assert path == [state]
        if state is S.QUICK_STOP_ACTIVE or goal is not Goal.ENABLED:
            assert S.OPERATION_ENABLED not in path[1:]


@pytest.mark.parametrize(
    "state", [S.SWITCH_ON_DISABLED, S.READY_TO_SWITCH_ON, S.SWITCHED_ON, S.OPERATION_ENABLED, S.QUICK_STOP_ACTIVE]
)
def test_disabling_ends_without_power(state):
    assert reach(state, Goal.DISABLED)[-1] is S.SWITCH_ON_DISABLED


@pytest.mark.parametrize("goal", list(Goal))
def test_a_stopped_drive_is_never_told_to_go_on(goal):
    """Drives have transition 16: from QUICK STOP ACTIVE, ENABLE_OPERATION would set them moving again."""
    assert next_command(S.QUICK_STOP_ACTIVE, goal) in (C.QUICK_STOP, C.DISABLE_VOLTAGE)


def test_stopping_brakes_an_enabled_drive_and_holds_it():
    assert reach(S.OPERATION_ENABLED, Goal.STOPPED)[-1] is S.QUICK_STOP_ACTIVE
