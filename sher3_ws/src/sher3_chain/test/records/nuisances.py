"""Nuisances of a record: what a logger, a cable or a converter does to columns without changing the machine.

Each is a pure function of columns: `nuisance(record, size, rng)` returns a new record. `size` is 1, 2 or 3: slight,
usual, strong. A nuisance that does not apply to a record, since it has no such column, returns None.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Record:
    """One record as columns.

    Attributes:
        columns: name -> (n,) numbers; every column has the same rows.
        roles: role -> name of its column: `time`, and any of position, reference, command, effort, load, applied,
            reading, temperature.
        scales: column -> factor that makes SI of its numbers, beyond what the description says.
        counts: role -> smallest step of its column, in the numbers of the column.
    """

    columns: Mapping[str, Array]
    roles: Mapping[str, str]
    scales: Mapping[str, float]
    counts: Mapping[str, float]

    def of(self, role: str) -> Array | None:
        """Return the column of a role; None where there is none."""
        return self.columns[self.roles[role]] if role in self.roles else None

    def with_column(self, role: str, values: Array, scale: float = 1.0) -> Record:
        """Return the record with another column of a role, whose numbers are to be multiplied by `scale`."""
        name = self.roles[role]
        scales = {**self.scales, name: self.scales.get(name, 1.0) * scale}
        return replace(self, columns={**self.columns, name: values}, scales=scales)

    def rows(self, kept: Array) -> Record:
        """Return the record with some of its rows, by mask or index."""
        return replace(self, columns={name: x[kept] for name, x in self.columns.items()})


Nuisance = Callable[[Record, int, np.random.Generator], Record | None]


def _on(role: str, change: Callable[[Array, int, np.random.Generator, Record], Array]) -> Nuisance:
    """Return a nuisance that changes the column of one role."""

    def nuisance(record: Record, size: int, rng: np.random.Generator) -> Record | None:
        x = record.of(role)
        return None if x is None else record.with_column(role, change(x, size, rng, record))

    return nuisance


def _unit(role: str) -> Nuisance:
    """Return a nuisance that records a role in thousandths, hundredths or tenths; the description says so."""

    def nuisance(record: Record, size: int, rng: np.random.Generator) -> Record | None:
        x, factor = record.of(role), 10.0 ** (4 - size)
        return None if x is None else record.with_column(role, x * factor, 1.0 / factor)

    return nuisance


def _zero(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    return x + (0.01, 0.1, 1.0)[size - 1] * float(np.ptp(x))


def _turned(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    return (0.0, 1.0, -1.0)[size - 1] * float(np.ptp(x)) - x


def _opposite(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    return -x


def _hold(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    return x[np.arange(len(x)) // (size + 1) * (size + 1)]


def _long_hold(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    every = (6, 10, 16)[size - 1]
    return x[np.arange(len(x)) // every * every]


def _counted(role: str) -> Nuisance:
    def change(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
        step = record.counts.get(role, 0.0) or float(np.ptp(x)) * 1e-4
        return np.round(x / (0.25 * size * step)) * 0.25 * size * step

    return _on(role, change)


def _outliers(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    out = x.copy()
    at = rng.choice(np.arange(5, len(x) - 5), size=size, replace=False)
    out[at] += 5.0 * float(np.ptp(x)) * rng.choice([-1.0, 1.0], size)
    return out


def _jitter(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    step = float(np.median(np.diff(x)))
    return x + 0.003 * size * step * rng.uniform(-1.0, 1.0, len(x))


def _noisy_clock(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    step = float(np.median(np.diff(x)))
    return x + (0.05, 0.2, 0.4)[size - 1] * step * rng.uniform(-1.0, 1.0, len(x))


def _rounded_clock(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    step = (0.4, 2.5, 5.0)[size - 1] * float(np.median(np.diff(x)))
    return np.floor(x / step) * step


def _later(x: Array, size: int, rng: np.random.Generator, record: Record) -> Array:
    return x + (1.0, 1e3, 1e6)[size - 1]


def drop_rows(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Leave single rows out: one in a thousand, two, three."""
    n = len(next(iter(record.columns.values())))
    kept = np.ones(n, dtype=bool)
    kept[rng.choice(np.arange(2, n - 2), size=max(1, size * n // 1000), replace=False)] = False
    return record.rows(kept)


def repeat_rows(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Write single rows twice, stamp included: one in a hundred, two, three. A table without a clock has none."""
    n = len(next(iter(record.columns.values())))
    if "time" not in record.roles:
        return None
    twice = rng.choice(np.arange(2, n - 2), size=max(1, size * n // 100), replace=False)
    return record.rows(np.sort(np.concatenate([np.arange(n), twice])))


def cut_start(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Start the logger late: by 2, 4, 6 percent of the record."""
    n = len(next(iter(record.columns.values())))
    return record.rows(np.arange(size * n // 50, n))


def cut_end(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Stop the logger early: by 2, 4, 6 percent of the record."""
    n = len(next(iter(record.columns.values())))
    return record.rows(np.arange(n - size * n // 50))


def slower_log(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Log every second, third or fourth row. A table without a clock has no rows to spare."""
    n = len(next(iter(record.columns.values())))
    return record.rows(np.arange(0, n, size + 1)) if "time" in record.roles else None


def polled_rows(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Poll faster than the samples come: one in fifty rows, one in eight, one in three repeats the row before."""
    if "time" not in record.roles:
        return None
    n = len(record.columns[record.roles["time"]])
    again = rng.random(n) < (0.02, 0.125, 0.33)[size - 1]
    again[[0, -1]] = False
    last = np.maximum.accumulate(np.where(again, 0, np.arange(n)))
    columns = {name: x if name == record.roles["time"] else x[last] for name, x in record.columns.items()}
    return replace(record, columns=columns)


def silent_effort(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Lose the effort for 4, 8, 12 percent of the record: it reads exactly zero."""
    x = record.of("effort")
    if x is None:
        return None
    first, lost = len(x) // 3, size * len(x) // 25
    return record.with_column("effort", np.where((np.arange(len(x)) - first) // lost == 0, 0.0, x))


def further_columns(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Write columns that nobody described: a counter, a constant, noise."""
    n = len(next(iter(record.columns.values())))
    more = {"counter": np.arange(n, dtype=float), "flag": np.ones(n), "noise": rng.normal(size=n)}
    return replace(record, columns={**dict(list(more.items())[:size]), **record.columns})


def other_order(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Write the columns in another order."""
    names = list(record.columns)
    names = names[size % len(names) :] + names[: size % len(names)]
    return replace(record, columns={name: record.columns[name] for name in names})


def both_zeros(record: Record, size: int, rng: np.random.Generator) -> Record | None:
    """Count position and reference from another zero, as a slide without a weight does not notice."""
    if record.of("position") is None or record.of("reference") is None:
        return None
    shift = (0.01, 0.1, 1.0)[size - 1] * float(np.ptp(record.of("position")))
    for role in ("position", "reference"):
        record = record.with_column(role, record.of(role) + shift)
    return record


NUISANCES: Mapping[str, Nuisance] = {
    "zero of position and reference": both_zeros,
    "zero of the load encoder": _on("load", _zero),
    "turned load encoder": _on("load", _turned),
    "turned reference": _on("reference", _opposite),
    "held effort": _on("effort", _hold),
    "held position": _on("position", _hold),
    "slow position": _on("position", _long_hold),
    "held load encoder": _on("load", _hold),
    "held reference": _on("reference", _hold),
    "counts of the position": _counted("position"),
    "counts of the load encoder": _counted("load"),
    "counts of the effort": _counted("effort"),
    "counts of the reading": _counted("reading"),
    "outliers of the position": _on("position", _outliers),
    "outliers of the effort": _on("effort", _outliers),
    "outliers of the load encoder": _on("load", _outliers),
    "jitter of the clock": _on("time", _jitter),
    "noisy stamps": _on("time", _noisy_clock),
    "rounded stamps": _on("time", _rounded_clock),
    "another start of the clock": _on("time", _later),
    "unit of the position": _unit("position"),
    "unit of the effort": _unit("effort"),
    "unit of the load encoder": _unit("load"),
    "unit of the command": _unit("command"),
    "unit of the reading": _unit("reading"),
    "unit of the applied force": _unit("applied"),
    "dropped rows": drop_rows,
    "repeated rows": repeat_rows,
    "polled rows": polled_rows,
    "slower log": slower_log,
    "silent effort": silent_effort,
    "late start": cut_start,
    "early end": cut_end,
    "further columns": further_columns,
    "another order of columns": other_order,
}
"""Every nuisance by its name in a list of misses."""
SIZES = (1, 2, 3)
"""Slight, usual, strong."""
