"""The CiA 402 drive state machine as a table: statusword in, controlword out. Pure, without time and without CAN.

IEC 61800-7-201 (CiA 402-2), figure "Finite state automaton" and its tables "Controlword command coding" and
"Statusword state coding". The driver never leaves FAULT by itself: FAULT_RESET is a command of its own, and a drive
acts on its rising edge alone.
"""

from __future__ import annotations

from enum import Enum, IntEnum

from sher3_drivers.errors import UnknownStatusword

CYCLIC_SYNCHRONOUS_VELOCITY = 9
"""Mode of operation `csv`, object 0x6060."""


class DriveState(Enum):
    """States of a drive; the value is (mask, pattern) of the statusword."""

    NOT_READY_TO_SWITCH_ON = (0x4F, 0x00)
    SWITCH_ON_DISABLED = (0x4F, 0x40)
    READY_TO_SWITCH_ON = (0x6F, 0x21)
    SWITCHED_ON = (0x6F, 0x23)
    OPERATION_ENABLED = (0x6F, 0x27)
    QUICK_STOP_ACTIVE = (0x6F, 0x07)
    FAULT_REACTION_ACTIVE = (0x4F, 0x0F)
    FAULT = (0x4F, 0x08)


class Controlword(IntEnum):
    """Commands of the host; the value is the controlword without mode-specific bits."""

    DISABLE_VOLTAGE = 0x00
    QUICK_STOP = 0x02
    SHUTDOWN = 0x06
    SWITCH_ON = 0x07
    ENABLE_OPERATION = 0x0F
    FAULT_RESET = 0x80


class Goal(Enum):
    """Where the host wants a drive to be."""

    DISABLED = "disabled"
    ENABLED = "enabled"
    STOPPED = "stopped"


class StatusBit(IntEnum):
    """Numbers of the statusword bits that do not tell the state."""

    VOLTAGE_ENABLED = 4
    WARNING = 7
    REMOTE = 9
    INTERNAL_LIMIT = 11
    FOLLOWS_COMMAND = 12


_S, _C = DriveState, Controlword

TRANSITIONS: dict[tuple[DriveState, Controlword], DriveState] = {
    (_S.SWITCH_ON_DISABLED, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,  # 2
    (_S.READY_TO_SWITCH_ON, _C.SWITCH_ON): _S.SWITCHED_ON,  # 3
    (_S.READY_TO_SWITCH_ON, _C.ENABLE_OPERATION): _S.SWITCHED_ON,  # 3; 4 follows with the same controlword
    (_S.SWITCHED_ON, _C.ENABLE_OPERATION): _S.OPERATION_ENABLED,  # 4
    (_S.OPERATION_ENABLED, _C.SWITCH_ON): _S.SWITCHED_ON,  # 5, "disable operation"
    (_S.SWITCHED_ON, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,  # 6
    (_S.READY_TO_SWITCH_ON, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,  # 7
    (_S.READY_TO_SWITCH_ON, _C.QUICK_STOP): _S.SWITCH_ON_DISABLED,  # 7
    (_S.OPERATION_ENABLED, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,  # 8
    (_S.OPERATION_ENABLED, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,  # 9
    (_S.SWITCHED_ON, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,  # 10
    (_S.SWITCHED_ON, _C.QUICK_STOP): _S.SWITCH_ON_DISABLED,  # 10
    (_S.OPERATION_ENABLED, _C.QUICK_STOP): _S.QUICK_STOP_ACTIVE,  # 11
    (_S.QUICK_STOP_ACTIVE, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,  # 12
    (_S.FAULT, _C.FAULT_RESET): _S.SWITCH_ON_DISABLED,  # 15
}
"""Every transition a command causes, with its number in CiA 402-2; any other command leaves the state as it is.

Transitions 0, 1, 13 and 14 are the drive's own. Number 16 (ENABLE_OPERATION in QUICK_STOP_ACTIVE leads back to
OPERATION_ENABLED) is left out on purpose: a drive that was stopped is disabled first.
"""

# What to send in a state to get one step towards a goal; where nothing is named, DISABLE_VOLTAGE leads there.
_TOWARDS: dict[Goal, dict[DriveState, Controlword]] = {
    Goal.ENABLED: {
        _S.SWITCH_ON_DISABLED: _C.SHUTDOWN,
        _S.READY_TO_SWITCH_ON: _C.SWITCH_ON,
        _S.SWITCHED_ON: _C.ENABLE_OPERATION,
        _S.OPERATION_ENABLED: _C.ENABLE_OPERATION,
        _S.QUICK_STOP_ACTIVE: _C.QUICK_STOP,
    },
    Goal.DISABLED: {_S.OPERATION_ENABLED: _C.SWITCH_ON, _S.SWITCHED_ON: _C.SHUTDOWN},
    Goal.STOPPED: {_S.OPERATION_ENABLED: _C.QUICK_STOP, _S.QUICK_STOP_ACTIVE: _C.QUICK_STOP},
}


def decode_status(statusword: int) -> DriveState:
    """Return the state a statusword encodes.

    Raises:
        UnknownStatusword: it encodes none.
    """
    for state in DriveState:
        mask, pattern = state.value
        if statusword & mask == pattern:
            return state
    raise UnknownStatusword(
        "the statusword encodes no CiA 402 state", value=f"0x{statusword:04x}", remedy="check the drive and its PDO map"
    )


def transition(state: DriveState, command: Controlword) -> DriveState:
    """Return the state a drive in `state` goes to on `command`."""
    return TRANSITIONS.get((state, command), state)


def next_command(state: DriveState, goal: Goal) -> Controlword:
    """Return the command that takes a drive from `state` one step towards `goal`, or keeps it there.

    It is never FAULT_RESET, and it never leads from QUICK_STOP_ACTIVE to OPERATION_ENABLED: both need an explicit
    decision first.
    """
    return _TOWARDS[goal].get(state, Controlword.DISABLE_VOLTAGE)
