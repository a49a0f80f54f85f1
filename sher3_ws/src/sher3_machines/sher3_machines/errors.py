"""The error of this package."""

from __future__ import annotations

from pathlib import Path

from sher3_common import Sher3Error


class MachineError(Sher3Error):
    """A description or a record that cannot be used; names the field or signal, its value, limit and remedy."""


def no_reader(path: Path, what: str, library: str, remedy: str) -> MachineError:
    """Return the error of a file whose reader needs a library that is not installed."""
    return MachineError(f"{path}: no reader for {what}", value=f"{library} is not installed", remedy=remedy)
