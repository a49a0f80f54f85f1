"""What a path holds as runs: a file or a folder is one; episodes of a data set, of a file and of a folder, one each.

Sheets of a workbook, and groups of a file, are to it what files are to a folder.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sher3_machines.intake.readers.lerobot import is_data_set, read_data_set
from sher3_machines.intake.tables import UNNAMED, Tables, is_bag, read_tables

EPISODES = (
    "demo|demonstration|ep|episode|exp|experiment|measurement|rec|record|recording|rep|repeat|repetition|"
    "rollout|run|seq|sequence|session|take|test|traj|trajectory|trial"
)
"""Words that people number runs by; joints, sensors and channels are numbered by others."""
WORD = rf"(?:[^/]*[ _-])?(?:{EPISODES})[ _-]?\d+(?:[ _-][^/]*)?"
NUMBERED = re.compile(rf"(?i:(?P<group>(?:[^/]+/)*?{WORD})/(?P<column>.+))")
"""A column of a group that is numbered as runs are: `data/demo_12/obs/q`, `fourier_test3_results/q`."""

FILE = re.compile(r"(?P<group>[^/]+)/(?P<column>.+)")
"""A column of a file of a folder, of a sheet, or of a group."""
DIGITS = re.compile(r"[ _-]?\d+")
STOPPED_TOGETHER = 10.0
"""Periods of the slowest file between whose ends those of the channels of one log lie, which stop together."""
NUMBERING = {"index", "id", "number", "cycle", *EPISODES.split("|")}
"""Words of columns that number the runs, or what was done in them."""
PARTS = "joint|axis|link|motor|drive|servo|wheel|leg|arm|finger|sensor|channel|ch|j|q|m"
PART = re.compile(rf"(?i:.*(?<![a-z])({PARTS})[ _-]?\d+([ _-].*)?)")
"""A file of a part of a machine: not each of them is a run."""


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
    holds a whole machine and they differ in a number, or where they cover different stretches of time, or where
    something was set for each; files of parts of a machine are none.
    """
    parts: dict[str, Tables] = defaultdict(dict)
    for name, x in tables.items():
        if match := named.fullmatch(name):
            parts[match["group"]][match["column"]] = x
    kinds = {(DIGITS.sub("#", group), *sorted(part)) for group, part in parts.items()}
    runs = len(kinds) == 1 and (named is NUMBERED or all(map(_whole, parts.values())))
    files, alike = list(parts.values()), len({tuple(sorted(part)) for part in parts.values()}) == 1
    by_file = named is FILE and alike and not all(map(PART.fullmatch, parts))
    if len(parts) < 2 or not (runs or (by_file and (_apart(files) or _was_set(files)))):
        return {}
    beside = {name: x for name, x in tables.items() if not name.startswith(tuple(f"{group}/" for group in parts))}
    return {group.replace("/", "_"): {**beside, **part} for group, part in parts.items()}


def _runs(path: Path) -> Mapping[str, Tables]:
    if is_data_set(path):
        return {name: dict(tables) for name, tables in read_data_set(path).episodes.items()}
    tables = read_tables(path)
    files = {} if is_bag(path) else episodes_in(tables, FILE)
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
    starts, ends, rows = np.array([_stretch(tables) for tables in files]).T
    slowest = float(np.max((ends - starts) / rows))
    return bool(np.ptp(ends) > STOPPED_TOGETHER * slowest or starts.max() >= ends.min())


def _stretch(tables: Tables) -> tuple[float, float, int]:
    """Return the first and last number of the first column that grows all along, or the rows' own, and their count."""
    for x in tables.values():
        if x.ndim == 1 and len(x) > 1 and (np.diff(x) >= 0.0).all() and x[-1] > x[0]:
            return float(x[0]), float(x[-1]), len(x)
    rows = max(1, *map(len, tables.values()))
    return 0.0, float(rows), rows


def longest(path: Path) -> Tables:
    """Return the run of a path with most samples, which a draft is made of; raises MachineError.

    Where something was set for each run and stays in it, the runs stand one below the other, so that it is seen.
    """
    runs = list(_runs(path).values())
    most = max(runs, key=lambda tables: max(map(len, tables.values()), default=0))
    if not _was_set(runs):
        return most
    return {name: np.concatenate([run[name] for run in runs]) for name in most if all(name in run for run in runs)}


def _was_set(runs: Sequence[Tables]) -> bool:
    """Return whether a column that numbers nothing stays in every run, and not at the same number in all of them."""
    named = [name for name in runs[0] if not NUMBERING & set(re.split(r"[\W_]+", name.lower()))]
    columns = [[run[name] for run in runs] for name in named if all(name in run for run in runs)]
    stay = (c for c in columns if all(x.ndim == 1 and len(x) and not np.ptp(x) for x in c))
    return any(len({float(x[0]) for x in c}) > 1 for c in stay)
