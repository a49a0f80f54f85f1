"""Errors of the paper's computations."""

from __future__ import annotations

from sher3_common import Sher3Error


class InfeasibleDesign(Sher3Error):
    """A delta stage that cannot be built or does not reach; carries the design's text."""

    def __init__(self, what: str, *, design: object, value: object, limit: object, remedy: str) -> None:
        super().__init__(f"{design}: {what}", value=value, limit=limit, remedy=remedy)
        self.design = str(design)


class BadData(Sher3Error):
    """Data that an identification cannot use."""
