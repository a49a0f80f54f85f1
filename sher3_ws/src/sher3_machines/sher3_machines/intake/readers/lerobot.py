"""LeRobot data sets on disk, version 2.1 and 3: `meta/info.json`, and Parquet files below `data/`.

Version 2.1 has a file for each episode, version 3 several episodes in a file; both name the episode in each row
(https://huggingface.co/docs/lerobot: the format of data sets). Neither says in which unit its joints are.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import read_json
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

INFO = Path("meta/info.json")
SIGNALS = {"observation.state": "pos", "action": "pos", "observation.velocity": "vel", "observation.effort": "effort"}
"""Feature of joints -> word behind the name of each."""
NEEDED = ("observation.state", "action")
SPELLED = {"observation.state": "state", "action": "actions"}
"""What libraries of policies write in place of the format's own names (openpi, https://github.com/Physical-Intelligence)."""
ROWS = ("timestamp", "frame_index", "episode_index")
"""Columns of every data set."""
VERSIONS = ("v2.0", "v2.1", "v3")
"""How the versions begin that are read."""
ON_GRID = 0.01
"""Share of a period by which stamps may be off the frame's number over the rate, and still be made of it: float32."""


@dataclass(frozen=True)
class DataSet:
    """A data set of joints.

    Attributes:
        robot: type of robot, as the data set names it.
        rate: frames per second, Hz.
        episodes: name -> tables: `timestamp` (n,), and `FEATURE/JOINT.pos` (n,) for every joint.
        total: episodes that it says it has.
        nominal: whether every stamp is its frame's number over the rate: such a clock hides what its loop missed.
    """

    robot: str
    rate: float
    episodes: Mapping[str, Mapping[str, Array]]
    total: int
    nominal: bool


def is_data_set(path: Path) -> bool:
    """Whether a folder is a LeRobot data set."""
    return (Path(path) / INFO).is_file()


def read_data_set(path: Path, wanted: Collection[int] = ()) -> DataSet:
    """Read a data set.

    Args:
        path: its folder.
        wanted: numbers of the episodes to read; empty: all.

    Raises:
        MachineError: no data set, another version, no joints, no such episode, or no reader of Parquet.
    """
    info = _info(path)
    features = {name: names for name in SIGNALS if (names := _joints(info, name))}
    flat = [f"{name}.{joint}" for name in features if name not in info["features"] for joint in features[name]]
    spelled = {name: info["spelled"].get(name, name) for name in features if name in info["features"]}
    rows = _rows(path, spelled | {name: name for name in (*ROWS, *flat)})
    found, nominal = {}, True
    for number in np.unique(rows["episode_index"]).astype(int):
        if wanted and number not in wanted:
            continue
        mine = np.flatnonzero(rows["episode_index"] == number)
        mine = mine[np.argsort(rows["frame_index"][mine], kind="stable")]
        tables = {"timestamp": rows["timestamp"][mine].astype(float)}
        off = tables["timestamp"] - rows["frame_index"][mine] / info["fps"]
        nominal &= bool(np.abs(off).max() * info["fps"] < ON_GRID)
        for name, joints in features.items():
            each = rows[name] if name in rows else np.column_stack([rows[f"{name}.{joint}"] for joint in joints])
            values = each[mine].reshape(len(mine), -1)
            tables |= {_column(name, joint): values[:, i].astype(float) for i, joint in enumerate(joints)}
        found[f"episode_{number:06d}"] = tables
    missing = set(wanted) - {int(name[-6:]) for name in found}
    if missing or not found:
        have = np.unique(rows["episode_index"]).astype(int)
        limit = f"{have[0]} to {have[-1]}" if len(have) else "none has rows"
        raise MachineError(f"{path}: no such episode", value=sorted(missing), limit=limit, remedy="correct `episodes`")
    total = int(info.get("total_episodes") or len(found))
    return DataSet(str(info.get("robot_type") or "robot"), float(info["fps"]), found, total, nominal)


def _info(path: Path) -> dict[str, Any]:
    if not is_data_set(path):
        raise MachineError(f"{path}: is no LeRobot data set", limit=f"a folder with {INFO}", remedy="give its folder")
    info = read_json(path / INFO)
    if not isinstance(info, dict) or not isinstance(info.get("features"), dict) or not float(info.get("fps") or 0) > 0:
        raise MachineError(f"{path / INFO}: `features` or `fps` is missing", remedy="check the data set")
    version = str(info.get("codebase_version", "none"))
    if not version.startswith(VERSIONS):
        remedy = "convert it with the library that wrote it"
        raise MachineError(f"{path}: version is not read", value=version, limit=", ".join(VERSIONS), remedy=remedy)
    known = info["features"]
    info["spelled"] = {name: other for name, other in SPELLED.items() if other in known and not _joints(info, name)}
    info["features"] = known | {name: known[other] for name, other in info["spelled"].items()}
    missing = [name for name in NEEDED if not _joints(info, name)]
    if missing:
        have = ", ".join(known)
        remedy = "give a data set with what the joints were told and what they did"
        raise MachineError(f"{path}: no feature {missing[0]!r}", limit=f"features: {have}", remedy=remedy)
    return info


def _joints(info: Mapping[str, Any], feature: str) -> list[str]:
    """Return the names of a feature's entries; some have them below keys or in lists of their own, some have none.

    Some data sets have a column for each joint, `FEATURE.JOINT.pos`.
    """
    if feature not in info["features"]:
        flat = [name.removeprefix(f"{feature}.") for name in info["features"] if name.startswith(f"{feature}.")]
        return [name for name in flat if name.endswith(f".{SIGNALS[feature]}")] or flat
    names, width = info["features"][feature].get("names"), info["features"][feature]["shape"][0]
    parts = names.values() if isinstance(names, dict) else names or ()
    flat = [str(x) for part in parts for x in (part if isinstance(part, list) else [part])]
    return flat if len(flat) == width else [f"joint{i + 1}" for i in range(width)]


def _column(feature: str, joint: str) -> str:
    word = SIGNALS[feature]
    return f"{feature}/{joint.replace('/', '_').removesuffix('.' + word)}.{word}"


def _rows(path: Path, columns: Mapping[str, str]) -> dict[str, Array]:
    """Return columns of all files below `data/`, one after the other, by name; `columns`: name -> column."""
    try:
        parquet = import_module("pyarrow.parquet")
    except ImportError as error:
        raise MachineError(
            f"{path}: no reader for Parquet", value="pyarrow is not installed", remedy="install sher3[lerobot]"
        ) from error
    files = sorted((path / "data").rglob("*.parquet"))
    if not files:
        raise MachineError(f"{path}: no Parquet file below data/", remedy="fetch the data set whole")
    try:
        tables = [parquet.read_table(file, columns=[*columns.values()]) for file in files]
        return {name: np.concatenate([_plain(table[x]) for table in tables]) for name, x in columns.items()}
    except (OSError, KeyError, ValueError) as error:  # pyarrow's own errors are of these
        value, need = str(error).splitlines()[0][:200], f"the columns {', '.join(columns.values())} in every file"
        raise MachineError(f"{path}: cannot be read", value=value, limit=need, remedy="check the data set") from error


def _plain(column: Any) -> Array:
    x = column.to_numpy()
    return np.stack(list(x)) if x.dtype == object else x
