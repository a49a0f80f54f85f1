"""The error of this package."""

from __future__ import annotations

from sher3_description import Sher3Error


class MachineError(Sher3Error):
    """A description or a record that cannot be used; names the field or the signal, its value, the limit and the remedy."""
