"""Errors of the diagnosis."""

from __future__ import annotations

from sher3_description import Sher3Error


class CaseError(Sher3Error):
    """A case that cannot be diagnosed."""
