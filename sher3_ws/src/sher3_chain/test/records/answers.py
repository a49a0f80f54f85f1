"""How a record as columns is answered."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from nuisances import Record
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Verdict
from sher3_machines import kinds


def answer(described: Mapping[str, Any], record: Record) -> Verdict:
    """Return the verdict on a record; factors of its columns are multiplied by those of the record."""
    kind = kinds()[described["kind"]]
    description = kind.description.model_validate(scaled(described, record.scales))
    parts, _ = kind.parts("run", dict(record.columns), description)
    runs = [kind.read(name, columns, description) for name, columns in parts.items()]
    return diagnose(kind.machine(description), runs).verdict


def scaled(part: Any, scales: Mapping[str, float]) -> Any:
    """Return a description whose columns have their factors multiplied."""
    if isinstance(part, list | tuple):
        return [scaled(x, scales) for x in part]
    if not isinstance(part, Mapping):
        return part
    out = {key: scaled(x, scales) for key, x in part.items()}
    if isinstance(part.get("column"), str) and scales.get(part["column"], 1.0) != 1.0:
        out["factor"] = part.get("factor", 1.0) * scales[part["column"]]
    return out
