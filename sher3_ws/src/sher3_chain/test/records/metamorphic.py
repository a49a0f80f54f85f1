"""Runs a record with each nuisance and compares the verdict with that of the clean record."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from nuisances import NUISANCES, SIZES, Record
from sher3_diagnosis.verdict import Verdict
from sher3_machines import MachineError

Answer = Callable[[Record], Verdict]
"""Imports a record and diagnoses it."""


class Outcome(NamedTuple):
    """What one nuisance did to one verdict: `difference` is empty where the verdict stayed."""

    nuisance: str
    size: int
    difference: str


def outcomes(record: Record, answer: Answer, names: Sequence[str] = tuple(NUISANCES)) -> Iterator[Outcome]:
    """Yield the outcome of each nuisance that applies to a record, at three sizes."""
    clean = answer(record)
    for name in names:
        for size in SIZES:
            rng = np.random.default_rng([zlib.crc32(name.encode()), size])
            changed = NUISANCES[name](record, size, rng)
            if changed is not None:
                yield Outcome(name, size, _difference(clean, changed, answer))


def _difference(clean: Verdict, changed: Record, answer: Answer) -> str:
    try:
        return difference(clean, answer(changed))
    except MachineError as error:
        return f"refused: {error}"


def difference(clean: Verdict, other: Verdict) -> str:
    """Return in words how a verdict differs: in status, causes, or a number outside the clean interval and its own."""
    if clean.status != other.status:
        return f"{clean.status} became {other.status}"
    first = {(c.effect, c.actuator, c.condition): c for c in clean.causes}
    second = {(c.effect, c.actuator, c.condition): c for c in other.causes}
    if set(first) != set(second):
        lost, new = (sorted(x[0] for x in s) for s in (set(first) - set(second), set(second) - set(first)))
        return f"lost {', '.join(lost) or 'nothing'}, gained {', '.join(new) or 'nothing'}"
    for key, cause in first.items():
        for name, p in cause.parameters.items():
            q = second[key].parameters.get(name)
            if q is not None and not (_holds(p, q.value) or _holds(q, p.value)):
                return f"{cause.effect} {name} {p.value:.4g} became {q.value:.4g}"
    return ""


def _holds(interval: object, value: float) -> bool:
    low, high = interval.low, interval.high  # type: ignore[attr-defined]
    return low is None or high is None or low <= value <= high


def table(found: Sequence[Outcome]) -> str:
    """Return the share of unchanged verdicts and every miss by name."""
    misses = [x for x in found if x.difference]
    share = 1.0 - len(misses) / len(found)
    lines = [f"{len(found)} verdicts, {share:.1%} unchanged"]
    return "\n".join([*lines, *(f"  {x.nuisance}, size {x.size}: {x.difference}" for x in misses)])
