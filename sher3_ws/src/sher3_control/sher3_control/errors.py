"""What the control package refuses, as types; every error names value, limit and remedy (see `Sher3Error`)."""

from __future__ import annotations

from typing import Any

from sher3_common import Sher3Error


class SettingsError(Sher3Error):
    """A control setting or a live parameter is out of range or unknown."""


class CommandRejected(Sher3Error):
    """A motion command is refused; the first clause says why.

    Attributes:
        mode: CRTK name of the command.
    """

    def __init__(self, mode: str, why: str, **details: Any) -> None:
        super().__init__(f"{mode} rejected: {why}", **details)
        self.mode = mode


class OwnerConflict(CommandRejected):
    """Another mode owns the robot, or a command topic has more than one publisher.

    Attributes:
        owner: the mode that owns the robot, `unclear` where there are several publishers.
    """

    def __init__(self, mode: str, why: str, *, owner: str, **details: Any) -> None:
        super().__init__(mode, why, **details)
        self.owner = owner


class TareRefused(Sher3Error):
    """The tare is refused.

    Attributes:
        reason: `pressed`, `samples` (too few or too old), `faulty`, `moving`, `noisy`, `too_large` or `pulled`.
    """

    def __init__(self, reason: str, what: str, **details: Any) -> None:
        super().__init__(f"tare refused, {reason}: {what}", **details)
        self.reason = reason


class StateCommandRefused(Sher3Error):
    """A CRTK state command is refused in the present operating state.

    Attributes:
        command: the command.
        state: the operating state.
    """

    def __init__(self, command: str, state: str, why: str, **details: Any) -> None:
        super().__init__(f"state command {command} refused in {state}: {why}", **details)
        self.command = command
        self.state = state


class TrajectoryError(Sher3Error):
    """A point-to-point motion cannot be planned: start or goal is not finite."""
