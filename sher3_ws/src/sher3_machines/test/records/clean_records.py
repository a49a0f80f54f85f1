"""Clean records of a chain and of a table, and how each is answered."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from nuisances import Record
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Verdict
from sher3_machines import kinds
from slides import COUNT, KD, KP, MASS, PERIOD, driven


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


def slide(seconds: float = 16.0) -> tuple[dict[str, Any], Record]:
    """A slide under a force, 8 N of dry and 40 N/(m/s) of viscous friction, 500 Hz."""
    rows = driven(seconds, coulomb=8.0, viscous=40.0)
    names = ("position", "reference", "command")
    columns = {"t": np.arange(len(rows)) * PERIOD, **dict(zip(names, rows.T, strict=True))}
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {x: {"column": x, "unit": u} for x, u in zip(names, ("m", "m", "N"), strict=True)},
        "command_law": {"kind": "force", "position_gain": KP, "velocity_gain": KD, "held": True},
        "mass": MASS,
        "encoder_resolution": COUNT,
    }
    described = {"kind": "axes", "name": "slide", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, Record(columns, {"time": "t", **{x: x for x in names}}, {}, {"position": COUNT})


def cell() -> tuple[dict[str, Any], Record]:
    """A load cell of 500 N with a zero of 2 N and a gain 1 % high, noise 0.05 N, three cycles."""
    up = np.arange(0.0, 501.0, 50.0)
    force = np.concatenate([np.tile(np.concatenate([up, up[-2:0:-1]]), 3), [0.0]])
    reading = 2.0 + 1.01 * force + np.random.default_rng(1).normal(0.0, 0.05, len(force))
    described = {
        "kind": "load_cell",
        "name": "cell",
        "applied": {"column": "force", "unit": "N"},
        "reading": {"column": "read", "unit": "N"},
    }
    columns = {"force": force, "read": reading}
    return described, Record(columns, {"applied": "force", "reading": "read"}, {}, {"reading": 0.05})
