"""The paper's printed tables as typed data, in SI units."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common import read_yaml

from sher3_paper.errors import BadData

Floats = NDArray[np.float64]
DATA = Path(__file__).parent


class TorsionTable(NamedTuple):
    """The table of torsional compliances, arrays (n,).

    Attributes:
        label: printed offset angle psi [rad].
        platform_radius: printed r_p [m].
        leg_width: printed w [m].
        compliance: measured average torsional compliance [rad/(N m)].
    """

    label: Floats
    platform_radius: Floats
    leg_width: Floats
    compliance: Floats


class DeflectionTable(NamedTuple):
    """The table of grasp-point compliances: positions (n, 2) [m] of P and compliances (n, 3) [m/N] along x, y, z."""

    positions: Floats
    compliance: Floats


@lru_cache(maxsize=1)
def printed() -> dict[str, Any]:
    """Return the printed values as they stand in `paper.yaml`, in the paper's units."""
    return read_yaml(DATA / "paper.yaml")


@lru_cache(maxsize=1)
def inconsistencies() -> list[dict[str, str]]:
    """Return the paper's inconsistencies, each with what it says, what we find and the position taken."""
    return read_yaml(DATA / "inconsistencies.yaml")["inconsistencies"]


def torsion_table() -> TorsionTable:
    """Return the 23 torsional compliances measured without springs."""
    rows = np.array(printed()["torsion_table"]["rows"], dtype=float)
    return TorsionTable(np.radians(rows[:, 0]), rows[:, 1] * 1e-3, rows[:, 2] * 1e-3, np.radians(rows[:, 3]))


def deflection_table() -> DeflectionTable:
    """Return the compliances of the grasping point at five positions."""
    table = printed()["deflection_table"]
    columns = [table[axis] for axis in "xyz"]
    return DeflectionTable(np.array(table["positions"]) * 1e-3, np.array(columns, dtype=float).T * 1e-6)


def require_rows(count: int, least: int, what: str) -> None:
    """Raise BadData when there are fewer than `least` rows of `what`."""
    if count < least:
        raise BadData(f"too few rows of {what}", value=count, limit=f">= {least}", remedy="measure more")
