"""How a measurement of the safety matrix can fail."""

from __future__ import annotations

from sher3_common import Sher3Error


class MeasurementError(Sher3Error):
    """A bag does not show what a cell of the matrix is to be judged by."""
