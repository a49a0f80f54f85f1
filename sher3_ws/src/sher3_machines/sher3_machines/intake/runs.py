"""What a path holds as runs: a file or a folder is one, a LeRobot data set one for each episode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from sher3_machines.intake.readers.lerobot import is_data_set, read_data_set
from sher3_machines.intake.tables import Tables, read_tables


def runs_of(data: Sequence[Path]) -> dict[str, Tables]:
    """Return the tables of every run by its name: that of its file, numbered where two are alike.

    Raises:
        MachineError: as `read_tables` and `read_data_set` do.
    """
    found = [(name, tables) for path in data for name, tables in _runs(path).items()]
    names = [name for name, _ in found]
    if len(set(names)) < len(names):
        names = [f"{name}_{i}" for i, name in enumerate(names)]
    return {name: tables for name, (_, tables) in zip(names, found, strict=True)}


def _runs(path: Path) -> Mapping[str, Tables]:
    if is_data_set(path):
        return {name: dict(tables) for name, tables in read_data_set(path).episodes.items()}
    return {path.resolve().name if path.is_dir() else path.stem: read_tables(path)}


def longest(path: Path) -> Tables:
    """Return the run of a path with most samples, which a draft is made of; raises MachineError."""
    return max(_runs(path).values(), key=lambda tables: max(map(len, tables.values()), default=0))
