"""A baseline entry: the verdict of a good log, and the floor of every place, with or without a gap."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_common import FileError, read_text
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.verdict import Verdict

from sher3_public.errors import InputError

MAX_BYTES = 50_000_000
"""Largest file that is read as a baseline."""
Schema = Literal["sher3.baseline/1"]


class Schemed(BaseModel):
    """A file of this project, which names its schema."""

    schema_: str = Field(alias="schema")


class Floor(BaseModel):
    """What repeats without any gap at one place: rms, and its unit."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    value: float = Field(ge=0.0)
    unit: str


class Entry(BaseModel):
    """What one log said.

    Attributes:
        verdict: of the diagnosis.
        floors: `stage/actuator` -> its floor.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    verdict: Verdict
    floors: dict[str, Floor] = {}


class Baseline(BaseModel):
    """What logs said, by name of the log."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)
    schema_: Schema = Field(default="sher3.baseline/1", alias="schema")
    logs: dict[str, Entry]

    def entry(self, log: str) -> Entry:
        """Return the entry of a log; one entry serves all. Raises InputError where the baseline has no such log."""
        found = self.logs.get(log)
        if found is None and len(self.logs) == 1:
            return next(iter(self.logs.values()))
        if found is None:
            remedy = "record the baseline with all logs"
            raise InputError("the baseline has no such log", value=log, limit=", ".join(self.logs), remedy=remedy)
        return found

    def to_json(self) -> str:
        """Return the baseline as JSON text."""
        return self.model_dump_json(by_alias=True, indent=1) + "\n"


def entry_of(diagnosis: Diagnosis[Any]) -> Entry:
    """Return a diagnosis as a baseline entry."""
    floors: dict[str, Floor] = {}
    for finding in diagnosis.findings:
        units: Any = finding.evidence.units
        for gap in finding.gaps:
            unit = units[gap.channel] if isinstance(units, Mapping) else "1"
            floors[f"{gap.channel.stage}/{gap.channel.actuator}"] = Floor(value=gap.floor, unit=unit)
    return Entry(verdict=diagnosis.verdict, floors={**floors, **floors_of(diagnosis.verdict)})


def floors_of(verdict: Verdict) -> dict[str, Floor]:
    """Return the floors that a verdict tells: those of its places."""
    return {f"{w.stage}/{w.actuator}": Floor(value=w.floor, unit=w.unit) for w in verdict.where}


def read_baseline(path: Path) -> Baseline:
    """Read a baseline, or a verdict.json, which then stands for every log.

    Raises:
        InputError: no such file, or it is neither.
    """
    try:
        text = read_text(path, MAX_BYTES)
    except FileError as error:
        raise InputError(f"{path}: cannot be read", value=error.reason, remedy="record one with --record") from error
    try:
        head = Schemed.model_validate_json(text)
        if not head.schema_.startswith("sher3.verdict/"):
            return Baseline.model_validate_json(text)
        verdict = Verdict.model_validate_json(text)
        return Baseline(logs={path.stem: Entry(verdict=verdict, floors=floors_of(verdict))})
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        remedy = "give a verdict.json, or what --record wrote"
        raise InputError(f"{path} is no baseline", value=f"{place}: {first['msg']}", remedy=remedy) from error
