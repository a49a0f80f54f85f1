"""What a path holds as runs: a file or a folder is one; episodes of a data set, of a file and of a folder, one each."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sher3_machines.intake.readers.lerobot import is_data_set, read_data_set
from sher3_machines.intake.tables import UNNAMED, Tables, read_tables

EPISODES = (
    "demo|demonstration|ep|episode|exp|experiment|measurement|rec|record|recording|rep|repeat|repetition|"
    "rollout|run|seq|sequence|session|take|test|traj|trajectory|trial"
)
"""Words that people number runs by; joints, sensors and channels are numbered by others."""
WORD = rf"(?:[^/]*[ _-])?(?:{EPISODES})[ _-]?\d+(?:[ _-][^/]*)?"
NUMBERED = re.compile(rf"(?i:(?P<group>(?:[^/]+/)*?{WORD})/(?P<column>.+))")
"""A column of a group that is numbered as runs are: `data/demo_12/obs/q`, `fourier_test3_results/q`."""

FILE = re.compile(r"(?P<group>[^/]+)/(?P<column>.+)")
"""A column of a file of a folder."""
DIGITS = re.compile(r"[ _-]?\d+")
LONGER = 1.1
"""Duration of one file over that of another from which they are no channels of one log, which start and stop together.
"""


def runs_of(data: Sequence[Path]) -> dict[str, Tables]:
    """Return the tables of every run by its name: that of its file or episode, numbered where two are alike.

    Raises:
        MachineError: as `read_tables` and `read_data_set` do.
    """
    found = [(name, tables) for path in data for name, tables in _runs(path).items()]
    names = [name for name, _ in found]
    if len(set(names)) < len(names):
        names = [f"{name}_{i}" for i, name in enumerate(names)]
    return {name: tables for name, (_, tables) in zip(names, found, strict=True)}


def episodes_in(tables: Tables, named: re.Pattern[str] = NUMBERED) -> dict[str, Tables]:
    """Return the runs of a file or folder by name: groups numbered as runs are, or files, with the same columns.

    What stands beside them belongs to each of them. Empty where there are no two such groups. Files are runs where each
    holds a whole machine and they differ in a number, or where they cover different stretches of time.
    """
    parts: dict[str, Tables] = defaultdict(dict)
    for name, x in tables.items():
        if match := named.fullmatch(name):
            parts[match["group"]][match["column"]] = x
    kinds = {(DIGITS.sub("#", group), *sorted(part)) for group, part in parts.items()}
    runs = len(kinds) == 1 and (named is NUMBERED or all(map(_whole, parts.values())))
    if len(parts) < 2 or not (runs or (named is FILE and _apart(list(parts.values())))):
        return {}
    beside = {name: x for name, x in tables.items() if not name.startswith(tuple(f"{group}/" for group in parts))}
    return {group.replace("/", "_"): {**beside, **part} for group, part in parts.items()}


def _runs(path: Path) -> Mapping[str, Tables]:
    if is_data_set(path):
        return {name: dict(tables) for name, tables in read_data_set(path).episodes.items()}
    tables = read_tables(path)
    files = episodes_in(tables, FILE) if path.is_dir() else {}
    return episodes_in(tables) or files or {path.resolve().name if path.is_dir() else path.stem: tables}


def _whole(tables: Tables) -> bool:
    """Return whether a file holds all joints of a machine, a matrix or columns that differ in a number: it is a run.

    Files that are numbered by joints, sensors or channels hold one each.
    """
    alike = [DIGITS.sub("#", name) for name in tables if not UNNAMED.fullmatch(name)]
    return any(x.ndim == 2 for x in tables.values()) or len(set(alike)) < len(alike)


def _apart(files: Sequence[Tables]) -> bool:
    """Return whether files of the same columns were recorded at different times, or for different ones: they are runs.

    Channels and joints of one machine are logged over one stretch of time, whatever their rates.
    """
    starts, ends = np.array([_stretch(tables) for tables in files]).T
    spans = ends - starts
    alike = len({tuple(sorted(tables)) for tables in files}) == 1
    return alike and bool(spans.max() > LONGER * spans.min() or starts.max() >= ends.min())


def _stretch(tables: Tables) -> tuple[float, float]:
    """Return the first and last number of the first column that grows all along, else the numbers of the rows."""
    for x in tables.values():
        if x.ndim == 1 and len(x) > 1 and (np.diff(x) >= 0.0).all() and x[-1] > x[0]:
            return float(x[0]), float(x[-1])
    return 0.0, float(max(map(len, tables.values()), default=0))


def longest(path: Path) -> Tables:
    """Return the run of a path with most samples, which a draft is made of; raises MachineError."""
    return max(_runs(path).values(), key=lambda tables: max(map(len, tables.values()), default=0))
