"""Errors of the plant."""

from __future__ import annotations

from sher3_common import Sher3Error


class EffectError(Sher3Error):
    """An effect that does not exist, sits on the wrong actuator or has a parameter out of its bounds."""


class InputError(Sher3Error):
    """A command, wrench or set-point the plant cannot be fed with: wrong shape or not finite."""
