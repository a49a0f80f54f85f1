"""Causes that no motion of a position servo tells apart: a dry friction, and a dead band of what it is commanded by.

A servo whose force c v is stiffness times error less a friction F, and a valve whose flow v is K times the error less a
band b, obey one equation: v = (error -+ b) / T beyond the band, none within it, b = F over stiffness. Their readings are
the same at any speed. The force, the command against its law, or a run under another load tells them.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.verdict import Cause
from sher3_effects.friction.coulomb_friction import ServoStiction
from sher3_effects.limit.command_deadband import CommandDeadband


def with_dead_band(causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes of a position servo with a dead band among the rivals of its stiction."""
    return [_beside(cause) if cause.effect == ServoStiction.id else cause for cause in causes]


def _beside(cause: Cause) -> Cause:
    return cause.model_copy(update={"rivals": list(dict.fromkeys([*cause.rivals, CommandDeadband.id]))})


def dead_band_note(name: str, causes: Sequence[Cause], unit: str) -> str:
    """Return what would tell a stiction from a dead band; empty where no stiction was found."""
    stuck = next((c.parameters["force"] for c in causes if c.effect == ServoStiction.id), None)
    if stuck is None:
        return ""
    return (
        f"{name}: friction, and a dead band of {stuck.value:.3g} {unit} either way (overlap of a valve, a zone of the "
        "controller), give a servo the same readings at any speed; the recorded force or pressure tells them apart, the "
        "command with its stated law does, and so do runs tagged with two loads: friction grows with the load, a band "
        "does not"
    )
