"""All kinds of faults: one or more for every effect id of the contract, and those outside."""

from __future__ import annotations

from sher3_challenge.truth import faults_drive, faults_outside, faults_tip
from sher3_challenge.truth.fault import FaultError, Kind

LIBRARY: dict[str, Kind] = {**faults_drive.CATALOGUE, **faults_tip.CATALOGUE}
OUTSIDE: dict[str, Kind] = dict(faults_outside.CATALOGUE)
EFFECTS: tuple[str, ...] = tuple(sorted({kind.effect for kind in LIBRARY.values()}))
"""The effect ids that some kind stands for."""


def kind_of(name: str) -> Kind:
    """Return the kind of that name; raises FaultError."""
    for catalogue in (LIBRARY, OUTSIDE):
        if name in catalogue:
            return catalogue[name]
    raise FaultError("no such fault", value=name, limit=", ".join([*LIBRARY, *OUTSIDE]))
