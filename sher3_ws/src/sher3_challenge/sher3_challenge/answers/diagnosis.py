"""The answers to one case: the verdict of the diagnosis and those of the baselines."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sher3_challenge.baselines.data import baseline_inputs
from sher3_challenge.baselines.rules import BASELINES


@dataclass(frozen=True)
class Answers:
    """The verdict on a case, those of the baselines, and what went wrong if there is none."""

    verdict: dict[str, Any] | None
    baselines: dict[str, dict[str, Any]] = field(default_factory=dict)
    error: str | None = None


def ask(case: Path, without: Collection[str], baselines: bool) -> Answers:
    """Diagnose a case folder; an error of the diagnosis is a missing verdict, not the end of the challenge."""
    from sher3_gap import diagnose_case

    started = time.perf_counter()
    try:
        diagnosis = diagnose_case(case, without=without)
    except Exception as error:  # whatever stops a diagnosis is reported with its case
        return Answers(None, error=f"{type(error).__name__}: {error}")
    verdict = diagnosis.verdict.model_dump(mode="json", by_alias=True)
    verdict["seconds"] = time.perf_counter() - started
    if not baselines:
        return Answers(verdict)
    data = baseline_inputs(diagnosis, case, without)
    return Answers(verdict, {name: baseline(data) for name, baseline in BASELINES.items()})
