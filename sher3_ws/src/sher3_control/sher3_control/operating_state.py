"""The CRTK operating state as a pure table.

The table of CRTK's `operating_state` page, with one restriction: FAULT is left by `disable` alone, never straight
into ENABLED.
"""

from enum import Enum


class OperatingState(str, Enum):
    """CRTK meta-states; the value is what `operating_state` carries."""

    DISABLED = "DISABLED"
    ENABLED = "ENABLED"
    PAUSED = "PAUSED"
    FAULT = "FAULT"


class StateCommand(str, Enum):
    """CRTK state commands; the value is what `command/state_command` carries."""

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
"""Every accepted pair; all others are refused and change nothing. No command leads into FAULT (CRTK)."""


def next_state(state: OperatingState, command: StateCommand) -> OperatingState | None:
    """Return the state after `command`, or None when the pair is refused."""
    return TRANSITIONS.get((state, command))
