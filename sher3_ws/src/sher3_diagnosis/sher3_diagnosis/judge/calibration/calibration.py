"""The calibration in force: coefficients, the reach of sets of rivals, and the cases they were set on."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field
from sher3_common import read_text

from sher3_diagnosis.judge.calibration.logistic import Logistic
from sher3_diagnosis.judge.calibration.typical import Typical

FILE = Path(__file__).with_name("calibration.json")


class Provenance(BaseModel):
    """Where the cases of one plant came from, and what its labels say of how imperfect its robots are.

    Attributes:
        plant: its name.
        cases, causes, gaps: how many.
        built: least and largest factor on deviations as built; None where labels do not say.
        shape: least and largest share of an effect's power by which its law is not its page's.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    plant: str
    cases: int
    causes: int
    gaps: int
    built: tuple[float, float] | None = None
    shape: tuple[float, float] | None = None


class Calibration(BaseModel):
    """What turns evidence into probabilities; written by `sher3 gap calibrate`.

    Attributes:
        cause: of a named cause: whether the effects in its place hold the true one (`library`), whether its gap has a
            cause outside the library, or none of its own (`no_gap`).
        gap: of a gap without a cause: outside the library, or no gap of its own.
        exact: of the causes of an exact stage: whether they are the true ones.
        sharpness: by how much a candidate's probability falls with its unlikeness: exp(-sharpness * unlikeness).
        reach: unlikeness up to which a candidate is in the set of rivals; conformal, so that the true effect of a case
            like those it was set on is in the set with probability `coverage` at least; never less than `same`.
        same: unlikeness up to which another effect gives the same data.
        typical: where the labelled causes lie, by which an unusual one is told; None in a file of before.
        provenance: the plants.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    schema_: Literal["sher3.calibration/1"] = Field(default="sher3.calibration/1", alias="schema")
    cause: Logistic
    gap: Logistic
    exact: Logistic
    sharpness: float
    reach: float
    coverage: float
    same: float
    typical: Typical | None = None
    provenance: tuple[Provenance, ...]

    def typicality(self, numbers: Mapping[str, float]) -> float | None:
        """Return the share of the labelled causes that are at least as unusual as one with this scaled evidence."""
        return None if self.typical is None else self.typical.typicality(self.cause, numbers)

    @classmethod
    def read(cls, path: Path) -> Calibration:
        """Read and validate a file; raises FileError, or `pydantic.ValidationError` naming each wrong field."""
        return cls.model_validate_json(read_text(path))


@lru_cache(maxsize=1)
def in_force() -> Calibration:
    """Return the calibration that the package carries."""
    return Calibration.read(FILE)
