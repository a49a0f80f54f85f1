"""The CRTK operating state: its words, the table of its changes, and the heartbeat that carries it.

The table is that of CRTK's `operating_state` page with one restriction: the only way out of FAULT is `disable`, which
leads to DISABLED. No command leads from FAULT straight into ENABLED.
"""

from __future__ import annotations

from enum import Enum

from sher3_common.reasons import Action


class OperatingState(str, Enum):
    """CRTK meta-states; the value is the text on `operating_state`, and equal to it."""

    DISABLED = "DISABLED"
    ENABLED = "ENABLED"
    PAUSED = "PAUSED"
    FAULT = "FAULT"


class StateCommand(str, Enum):
    """CRTK state commands; the value is the text on `command/state_command`, and equal to it."""

    ENABLE = "enable"
    DISABLE = "disable"
    PAUSE = "pause"
    RESUME = "resume"
    HOME = "home"
    UNHOME = "unhome"


_S, _C = OperatingState, StateCommand

TRANSITIONS: dict[tuple[OperatingState, StateCommand], OperatingState] = {
    (_S.DISABLED, _C.ENABLE): _S.ENABLED,
    (_S.DISABLED, _C.DISABLE): _S.DISABLED,
    (_S.DISABLED, _C.HOME): _S.DISABLED,
    (_S.DISABLED, _C.UNHOME): _S.DISABLED,
    (_S.ENABLED, _C.ENABLE): _S.ENABLED,
    (_S.ENABLED, _C.DISABLE): _S.DISABLED,
    (_S.ENABLED, _C.PAUSE): _S.PAUSED,
    (_S.PAUSED, _C.DISABLE): _S.DISABLED,
    (_S.PAUSED, _C.PAUSE): _S.PAUSED,
    (_S.PAUSED, _C.RESUME): _S.ENABLED,
    (_S.FAULT, _C.DISABLE): _S.DISABLED,
}
"""Every accepted pair of state and command, with the state it leads to. All other pairs are refused and change nothing.
No command leads into FAULT (CRTK)."""


def next_state(state: OperatingState, command: StateCommand) -> OperatingState | None:
    """Return the state after `command`, or None when the pair is refused."""
    return TRANSITIONS.get((state, command))


def heartbeat_text(state: OperatingState, action: Action) -> str:
    """Return the text on `supervisor/heartbeat`: `STATE ACTION`."""
    return f"{state.value} {action.name}"


def parse_heartbeat(text: str) -> tuple[OperatingState, Action] | None:
    """Return state and action of a heartbeat, None when the text is no heartbeat."""
    state, _, action = text.partition(" ")
    if state not in OperatingState.__members__ or action not in Action.__members__:
        return None
    return OperatingState[state], Action[action]
