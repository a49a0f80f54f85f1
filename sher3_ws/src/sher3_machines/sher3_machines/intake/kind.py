"""What a kind of machine gives: its description, its records, and the machine that the engine diagnoses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from sher3_diagnosis.channel import Array
from sher3_diagnosis.machine import Machine

from sher3_machines.intake.fields import Description
from sher3_machines.intake.tables import Tables


@dataclass
class Draft:
    """A description as YAML, and the guesses it rests on, one sentence each."""

    text: str
    guesses: list[str] = field(default_factory=list)


class Record(Protocol):
    """A run of any kind of machine."""

    @property
    def name(self) -> str:
        """Name of the run's file."""

    @property
    def notes(self) -> Sequence[str]:
        """What was done to the data, one sentence each, beginning with the run's name."""


D = TypeVar("D", bound=Description)
R = TypeVar("R", bound=Record)


class Kind(ABC, Generic[D, R]):
    """A kind of machine, found by the entry point that names it.

    Attributes:
        name: as the description's field `kind` gives it.
        description: the model of its description.
    """

    name: str
    description: type[D]

    @abstractmethod
    def read(self, name: str, tables: Tables, description: D) -> R:
        """Check a data file's columns and return them as a run in SI units; raises MachineError."""

    def chosen(self, records: Mapping[str, Tables], description: D) -> tuple[Mapping[str, Tables], str]:
        """Return the records of several that are judged, by name, and a note; default all."""
        return records, ""

    def parts(self, name: str, tables: Tables, description: D, records: int = 1) -> tuple[dict[str, Tables], str]:
        """Return the records that a data file, one of several, holds by name, and a note; default one."""
        return {name: tables}, ""

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft a description of a file that looks like this kind, default None; raises MachineError.

        Args:
            path: of the data.
            tables: what it holds.
            rate: samples per second, Hz, where no time was recorded.
            model: URDF or MJCF of the arm whose joints were recorded.
        """
        return None

    @abstractmethod
    def pack(self, run: R) -> Mapping[str, Array]:
        """Return the arrays of a run as a case stores them, signals (n, ...) of n samples."""

    @abstractmethod
    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> R:
        """Return the run that a case stores; raises KeyError where an array is missing."""

    @abstractmethod
    def machine(self, description: D) -> Machine[R, Any]:
        """Return the machine of a description; raises MachineError where its files cannot be used."""
