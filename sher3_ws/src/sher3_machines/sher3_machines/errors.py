"""The error of this package."""

from __future__ import annotations

from sher3_common import Sher3Error


class MachineError(Sher3Error):
    """A description or a record that cannot be used; names the field or signal, its value, limit and remedy."""
