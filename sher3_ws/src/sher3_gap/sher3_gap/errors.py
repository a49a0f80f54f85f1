"""Errors of the diagnosis."""

from __future__ import annotations

from sher3_common import Sher3Error


class CaseError(Sher3Error):
    """A case that cannot be diagnosed."""
