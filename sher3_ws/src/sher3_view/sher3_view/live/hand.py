"""Hand and foot on the live page: what a visitor lets the mocks feel."""

from __future__ import annotations

from dataclasses import dataclass

MOST_FORCE = 2.0
"""Largest push [N] on each axis: a firm hand; the law saturates at its speed cap before."""
COMMANDS = ("enable", "disable")
"""State commands with a button."""


@dataclass
class Hand:
    """What the page asks of the mocks.

    Attributes:
        touched: somebody has used the hand on the page; before that it publishes nothing.
        pedal: the pedal is pressed.
        force: push on the tip (3,) [N] in {b}.
        command: state command that is due, empty for none.
    """

    touched: bool = False
    pedal: bool = False
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    command: str = ""

    def taken(self) -> str:
        """Return the command that is due, once."""
        command, self.command = self.command, ""
        return command
