"""Errors of the public face."""

from __future__ import annotations

from sher3_common.errors import Sher3Error


class InputError(Sher3Error):
    """What was given cannot be diagnosed: an array of another shape, a model without such joints, a wrong keyword."""
