"""The error of this package."""

from __future__ import annotations

from sher3_common import Sher3Error


class ArmsError(Sher3Error):
    """A robot that is not there, a kind of fault that is not known, or MuJoCo missing."""
