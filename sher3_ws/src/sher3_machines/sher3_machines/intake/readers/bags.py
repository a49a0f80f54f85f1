"""Bags of ROS: rosbag2 (SQLite or MCAP), single MCAP files, ROS 1 bags; every topic is a table.

`TOPIC/FIELD` is the column of a field, without the slash the topic begins with. `TOPIC/stamp` is the time of the header
and `TOPIC/received` that of the recording, s. A message with one field beside its header is that field: the columns of
a WrenchStamped are `force` and `torque` (n, 3), of a PoseStamped `position` (n, 3) and `orientation` (n, 4; x y z w),
of a TwistStamped `linear` and `angular`. Of a JointState each joint is a table of its own: `TOPIC/JOINT/position`.
A message of long lists, one of which grows, has a row for each entry: samples with their own clock, sent in one piece.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from sher3_diagnosis.channel import Array

MAX_MESSAGES = 20_000_000
"""Messages of a bag: ten hours of 500 Hz."""
LONGEST = 64
"""Entries of an array field that become columns: joints and covariances, not images or scans."""
NANO = 1e-9
JOINTS = ("position", "velocity", "effort")


def read_bag(path: Path) -> dict[str, Array]:
    """Return every numeric field (messages, ...) of every topic; messages that cannot be decoded end the reading.

    Raises:
        ValueError: the bag cannot be read.
    """
    store = get_typestore(Stores.ROS2_JAZZY)
    rows: dict[str, dict[str, list[Any]]] = {}
    try:
        with AnyReader([path], default_typestore=store) as reader:
            if reader.message_count > MAX_MESSAGES:
                raise ValueError(f"{reader.message_count} messages, more than {MAX_MESSAGES}")
            for connection, received, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                for table, fields in tables_of(connection.topic.lstrip("/"), message, received * NANO):
                    into = rows.setdefault(table, {})
                    for name, value in fields.items():
                        into.setdefault(name, []).append(value)
    except ValueError:
        raise
    except Exception as error:  # the library has no base of its errors, and a damaged bag can raise any of them
        raise ValueError(f"{type(error).__name__}: {error}") from error
    return {f"{table}/{name}": x for table, found in rows.items() for name, x in columns(found).items()}


def tables_of(topic: str, message: Any, received: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the tables that a message is a row of, with its fields and when it was received, s."""
    fields = {name: getattr(message, name) for name in message.__dataclass_fields__ if not name.startswith("__")}
    header = fields.pop("header", None)
    stamp = {} if header is None else {"stamp": header.stamp.sec + NANO * header.stamp.nanosec}
    stamp["received"] = received
    if {"name", *JOINTS} <= fields.keys():
        for i, joint in enumerate(fields["name"]):
            found = {x: float(fields[x][i]) for x in JOINTS if i < len(fields[x])}
            yield f"{topic}/{joint}", {**stamp, **found}
        return
    if len(fields) == 1:
        (only,) = fields.values()
        if hasattr(only, "__dataclass_fields__"):
            fields = {name: getattr(only, name) for name in only.__dataclass_fields__ if not name.startswith("__")}
    samples = _samples(fields)
    for row in zip(*samples.values(), strict=True):
        yield topic, dict(zip(samples, map(float, row), strict=True))
    if not samples:
        yield topic, {**stamp, **dict(_leaves("", fields))}


def _samples(fields: dict[str, Any]) -> dict[str, Array]:
    """Return the lists of a message by name where they are samples: of one length (n,), and one of them a clock."""
    flat = {name: x for name, x in fields.items() if isinstance(x, np.ndarray) and x.dtype.kind in "fiu"}
    lists = {name: x for name, x in flat.items() if x.ndim == 1 and x.size > LONGEST}
    clocks = [x for x in lists.values() if (x[1:] > x[:-1]).all()]
    return lists if clocks and len({x.size for x in lists.values()}) == 1 < len(lists) else {}


def _leaves(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the numbers of a message by path; vectors and quaternions are one array each."""
    if hasattr(value, "__dataclass_fields__"):
        value = {x: getattr(value, x) for x in value.__dataclass_fields__ if not x.startswith("__")}
        if set(value) <= {"x", "y", "z", "w"} and name:
            yield name, np.array([float(x) for x in value.values()])
            return
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(f"{name}.{key}" if name else key, part)
    elif isinstance(value, bool | int | float | np.number):
        yield name, float(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "fiub" and 0 < value.size <= LONGEST:
        yield name, value.astype(float)


def columns(found: dict[str, list[Any]]) -> dict[str, Array]:
    """Return the columns (rows, ...) of a table that every row has, in the same shape."""
    rows = max(map(len, found.values()))
    out = {}
    for name, values in found.items():
        if len(values) == rows and len({np.shape(x) for x in values}) == 1:
            out[name] = np.array(values, dtype=float)
    return out
