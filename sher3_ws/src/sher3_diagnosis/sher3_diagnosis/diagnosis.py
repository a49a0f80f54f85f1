"""A verdict with what it rests on, for whoever shows it or goes on from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.machine import Machine

E = TypeVar("E", bound=Evidence)


@dataclass(frozen=True)
class Diagnosis(Findings[E]):
    """A verdict with what it rests on, and the machine that was diagnosed, for reports and further experiments."""

    machine: Machine[Any, E]
