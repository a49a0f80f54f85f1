"""Data files as named arrays; a folder is many tables, a bag a table for each topic."""

from __future__ import annotations

import csv
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from sher3_common import FileError
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError, no_reader
from sher3_machines.intake.readers.excel import read_workbook
from sher3_machines.intake.readers.hdf5 import ENDINGS as OF_HDF5
from sher3_machines.intake.readers.hdf5 import read_hdf5
from sher3_machines.intake.readers.mat import read_mat
from sher3_machines.intake.readers.packed import ENDINGS as PACKED
from sher3_machines.intake.readers.packed import unpack
from sher3_machines.intake.readers.shapes import SAMPLES
from sher3_machines.intake.readers.structured import read_lines, read_lists, read_npy, read_npz, read_parquet
from sher3_machines.intake.readers.text import read_table
from sher3_machines.intake.spelling import table_of

Tables = dict[str, Array]
MAX_BYTES = 2_000_000_000
"""Largest file that is read."""
UNNAMED = re.compile(r"c\d+")
"""Names of columns without a header."""
WIDE = 10
"""Columns for each row from which a table without a header has a row for each signal."""
SECONDS = re.compile(r"(?P<clock>(.*[/._])?)(secs?|seconds)")
NANOSECONDS = re.compile(r"(?P<clock>(.*[/._])?)(nanos|nsecs?|nanosecs?|nanoseconds)")
"""The two columns of a clock, as ROS and EPICS write them."""
DRAWN = re.compile(r"(?P<channel>.+)_(?P<side>[xy])")
"""A column of a curve, as plotters save what they drew: stamps as `NAME_x`, readings as `NAME_y`."""


def read_bag(path: Path) -> Tables:
    """Return the tables of a bag; its reader is imported when a bag is met, and raises MachineError where it is not."""
    try:
        from sher3_machines.intake.readers.bags import read_bag
    except ImportError as error:
        raise no_reader(path, "bags", str(error.name), "install sher3[bags]") from error
    return read_bag(path)


def read_packed(path: Path) -> Tables:
    """Return the tables of a packed file, of several files in it as `stem/name`; raises MachineError."""
    with tempfile.TemporaryDirectory() as folder:
        inside = unpack(path, Path(folder), MAX_BYTES)
        try:
            return read_tables(inside)
        except MachineError as error:
            what = f"{path}: {inside.name}" if inside.is_file() else str(path)
            reason = error.what.replace(str(inside), what)
            raise MachineError(reason, value=error.value, limit=error.limit, remedy=error.remedy) from error


READERS: dict[str, Callable[[Path], Tables]] = {
    ".csv": read_table,
    ".tsv": read_table,
    ".txt": read_table,
    ".dat": read_table,
    ".log": read_table,
    ".asc": read_table,
    ".mat": read_mat,
    ".npy": read_npy,
    ".npz": read_npz,
    ".json": read_lists,
    ".jsonl": read_lines,
    ".ndjson": read_lines,
    ".xlsx": read_workbook,
    ".parquet": read_parquet,
    ".mcap": read_bag,
    ".bag": read_bag,
    ".db3": read_bag,
    **dict.fromkeys(OF_HDF5, read_hdf5),
    **dict.fromkeys(PACKED, read_packed),
}
FROM_PICKLE = (
    "it may run code, so it is not opened here; where you trust it: "
    "python -c \"import pickle, numpy; numpy.savez('{stem}.npz', **pickle.load(open('{name}', 'rb')))\""
)
CONVERSIONS = {
    **dict.fromkeys((".pkl", ".pickle", ".p"), FROM_PICKLE),
    ".xls": "save it as xlsx",
    ".ods": "save it as xlsx",
    ".tdms": "write its channels as csv, as with `tdmsinfo` and pandas of the package nptdms",
    ".ulg": "convert it with `ulog2csv {name}` of the package pyulog",
    ".feather": "convert it to parquet with pandas",
}
"""What to do with files that are known and not read, by their ending."""
NOT_IN_FOLDERS = (".txt", ".dat", ".log", ".asc")
"""Endings that are read where they are named, and passed over in a folder beside others: there they are notes more
often.
"""


def read_tables(path: Path) -> Tables:
    """Return the numeric arrays of a file, or of a folder's files as `stem/name`; the first index counts samples.

    Raises:
        MachineError: no such file, no known format, or a table that cannot be read.
    """
    if is_rosbag2(path):
        return _read(path, read_bag)
    if path.is_dir():
        found = [
            f
            for f in sorted(path.iterdir())
            if (f.suffix.lower() in READERS and f.suffix not in NOT_IN_FOLDERS) or is_rosbag2(f)
        ]
        found = found or [f for f in sorted(path.iterdir()) if f.suffix in NOT_IN_FOLDERS and _is_table(f)]
        if not found:
            raise MachineError(f"{path}: no data files", limit=", ".join(READERS), remedy="give a file or its folder")
        return {f"{f.stem}/{name}": x for f in found for name, x in read_tables(f).items()}
    if not path.is_file():
        raise MachineError(f"{path}: no such file", remedy="check the path")
    reader = READERS.get(path.suffix.lower())
    if path.stat().st_size > MAX_BYTES:
        raise MachineError(f"{path}: too large", value=path.stat().st_size, limit=MAX_BYTES, remedy="cut the record")
    return _read(path, reader) if reader else _read_unknown(path)


def _read_unknown(path: Path) -> Tables:
    """Return the columns of a file whose ending says nothing: a table where it is text and holds one, else refused."""
    if not _is_table(path):
        limit, remedy = ", ".join(READERS), CONVERSIONS.get(path.suffix.lower(), "convert it to csv")
        remedy = remedy.format(name=path.name, stem=path.stem)
        raise MachineError(f"{path}: format is not read", value=path.suffix, limit=limit, remedy=remedy)
    return _read(path, read_table)


def _is_table(path: Path) -> bool:
    """Return whether a text holds a table of samples."""
    try:
        return any(len(x) >= SAMPLES for x in _read(path, read_table).values())
    except MachineError:
        return False


def upright(tables: Tables) -> Tables:
    """Return the arrays of a file with matrices (k, n) as (n, k), where lists of n samples stand beside them.

    MATLAB users write a row for each joint as often as one for each sample. Lists of the matrix' own table count before
    those of the file, and short lists, such as a gain for each joint, where there are none of samples alone. A table
    without a header, or a matrix by itself, that is much wider than long has a row for each signal.
    """
    rows = {x.shape for x in tables.values()} if all(map(UNNAMED.fullmatch, tables)) else set()
    if len(rows) == 1 and len(shape := rows.pop()) == 1 and _wide(shape[0], len(tables)):
        return {f"c{i}": row for i, row in enumerate(np.array(list(tables.values())).T)}
    return {n: np.ascontiguousarray(x.T) if x.ndim == 2 and _lies(n, x, tables) else x for n, x in tables.items()}


def _wide(rows: int, columns: int) -> bool:
    return rows < SAMPLES and columns > WIDE * rows


def _lies(name: str, x: Array, tables: Tables) -> bool:
    """Whether the matrix of a name has a column for each sample."""
    of_table = {len(y) for n, y in tables.items() if y.ndim == 1 and table_of(n) == table_of(name)}
    of_file = {len(y) for y in tables.values() if y.ndim == 1}
    for lists in (*({n for n in lists if n >= SAMPLES} for lists in (of_table, of_file)), of_table, of_file):
        if lists & set(x.shape):
            return x.shape[1] in lists and x.shape[0] not in lists
    return not of_file and _wide(*x.shape)


def as_long(tables: Tables) -> Tables:
    """Return the arrays of a file; of those that are one sample longer than others the last sample is left out.

    A state is logged once more than what was told between one and the next.
    """
    lengths = {(table_of(name), len(x)) for name, x in tables.items() if len(x) >= SAMPLES}
    return {name: x[:-1] if (table_of(name), len(x) - 1) in lengths else x for name, x in tables.items()}


def with_whole_clocks(tables: Tables) -> Tables:
    """Return the arrays of a file, and a column `stamp` for each clock in two columns: seconds, and nanoseconds."""
    found = dict(tables)
    for name, seconds in tables.items():
        match = SECONDS.fullmatch(name)
        rest = [n for n in tables if match and (other := NANOSECONDS.fullmatch(n)) and other["clock"] == match["clock"]]
        if match and len(rest) == 1 and tables[rest[0]].shape == seconds.shape:
            found.setdefault(f"{match['clock']}stamp", seconds + 1e-9 * tables[rest[0]])
    return found


def join_curves(tables: Tables) -> Tables:
    """Return columns that were saved as curves, `NAME_x` of stamps that grow and `NAME_y`, as channels with stamps."""
    curves = [DRAWN.fullmatch(name) for name in tables]
    names = {m["channel"] for m in curves if m}
    pairs = {name: (tables.get(f"{name}_x"), tables.get(f"{name}_y")) for name in names}
    if not tables or len(tables) != 2 * len(names) or not all(map(_is_curve, *zip(*pairs.values(), strict=True))):
        return tables
    found: Tables = {}
    for name in dict.fromkeys(m["channel"] for m in curves if m):
        x, y = tables[f"{name}_x"], tables[f"{name}_y"]
        known = np.isfinite(x) & np.isfinite(y)
        found |= {f"{name}/stamp": x[known], f"{name}/value": y[known]}
    return found


def _is_curve(x: Array | None, y: Array | None) -> bool:
    """Return whether columns (n,) are there and the first one grows all along."""
    if x is None or y is None or x.ndim != 1 or y.shape != x.shape:
        return False
    steps = np.diff(x[np.isfinite(x)])
    return len(steps) > 0 and bool((steps >= 0.0).all() and (steps > 0.0).any())


def is_rosbag2(path: Path) -> bool:
    """Whether a folder is a bag of ROS 2."""
    return path.is_dir() and (path / "metadata.yaml").is_file()


def is_bag(path: Path) -> bool:
    """Whether a file or a folder is a bag, whose groups are topics of one log."""
    return is_rosbag2(path) or READERS.get(path.suffix.lower()) is read_bag


def _read(path: Path, reader: Callable[[Path], Tables]) -> Tables:
    try:
        return join_curves(with_whole_clocks(as_long(upright(reader(path)))))
    except FileError as error:
        raise MachineError(
            f"{path}: {error.reason}", value=error.value, limit=error.limit, remedy=error.remedy or "check the file"
        ) from error
    except (OSError, ValueError, KeyError, IndexError, TypeError, RecursionError, csv.Error) as error:
        if isinstance(error, MachineError):
            raise
        raise MachineError(f"{path}: cannot be read", value=str(error)[:200], remedy="check the file") from error
