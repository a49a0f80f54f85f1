"""Errors of the engine."""

from sher3_common import Sher3Error


class UnknownEffect(Sher3Error):
    """An effect id that the library does not have."""
