"""Recorded runs in memory: one table of columns per topic."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_description.topics import TOPICS

from sher3_bags.errors import MissingTopicError, NotFiniteError, StampError, TopicError
from sher3_bags.messages import TEXT, TYPES

CONTRACT_TOPICS = (
    "setpoint_js",
    "servo_cv",
    "servo_jv",
    "drives/setpoint_jv",
    "drives/measured_js",
    "measured_js",
    "measured_cp",
    "force/measured_cf",
    "pedal/measured",
    "tracker/measured_cp",
    "temperature",
    "operating_state",
)
"""The topics of a run, in the order of the contract, section 4."""

Load = tuple[float, float, float, float, float]


@dataclass(frozen=True, eq=False)
class Stream:
    """All messages of one topic, columns by field name as attributes.

    Columns: JointState `position velocity effort` (n, 5), Twist `linear angular` (n, 3), Pose `position` (n, 3) and
    `orientation` (n, 4, x y z w), Wrench `force torque` (n, 3), Joy `axes buttons` (n, k), Temperature `temperature`
    (n,), String `data`, a tuple of n texts. A column the messages leave empty is None.

    Attributes:
        type: ROS interface, as in `sensor_msgs/msg/JointState`.
        stamp: (n,) int64, header stamps in ns; the log time where the type has no header.
        frame_id: the header's frame.
        columns: the columns by name.
        log_time: (n,) int64, ns at which each message was recorded; None means at its stamp.
    """

    type: str
    stamp: NDArray[np.int64]
    frame_id: str = ""
    columns: Mapping[str, Any] = field(default_factory=dict)
    log_time: NDArray[np.int64] | None = None

    def __len__(self) -> int:
        return len(self.stamp)

    def __getattr__(self, name: str) -> Any:
        columns = self.__dict__.get("columns", {})
        if name in columns:
            return columns[name]
        kind = TYPES.get(self.__dict__.get("type", ""))
        if kind is not None and (name in {f.name for f in kind.fields} or (name == "data" and not kind.header)):
            return None
        raise AttributeError(f"a stream of {self.__dict__.get('type')} has no column {name!r}")

    def seconds(self, origin: int | None = None) -> NDArray[np.float64]:
        """Return the stamps in s since `origin` [ns], by default the first stamp."""
        start = (self.stamp[0] if len(self) else 0) if origin is None else origin
        return np.multiply(self.stamp - start, 1e-9, dtype=np.float64)


def stream(
    topic: str,
    stamp: ArrayLike,
    *,
    frame_id: str | None = None,
    log_time: ArrayLike | None = None,
    **columns: ArrayLike | Iterable[str] | None,
) -> Stream:
    """Build the stream of a topic of the table, with its type and frame; columns as in `Stream`, converted and checked.

    Raises:
        TopicError: unknown topic or column, or a column whose shape is wrong.
    """
    if topic not in TOPICS:
        raise TopicError("no such topic in the table", topic=topic, remedy="use a name relative to /sher3")
    entry = TOPICS[topic]
    stamps = np.ascontiguousarray(stamp, dtype=np.int64)
    built = {name: _column(topic, entry.type, name, c, len(stamps)) for name, c in columns.items() if c is not None}
    logged = None if log_time is None else np.ascontiguousarray(log_time, dtype=np.int64)
    return Stream(entry.type, stamps, entry.frame_id if frame_id is None else frame_id, built, logged)


def _column(topic: str, type_name: str, name: str, values: Any, n: int) -> Any:
    if type_name == TEXT and name == "data":
        texts = tuple(str(value) for value in values)
        if len(texts) != n:
            raise TopicError(f"column {name} has the wrong length", topic=topic, value=len(texts), limit=n)
        return texts
    for entry in TYPES[type_name].fields if type_name in TYPES else ():
        if entry.name == name:
            array = np.ascontiguousarray(values, dtype=entry.code)
            width = 5 if TYPES[type_name].names else entry.count
            shape = (n,) if width == 1 else (n, array.shape[-1] if width is None else width)
            if array.shape != shape:
                raise TopicError(f"column {name} has the wrong shape", topic=topic, value=array.shape, limit=shape)
            return array
    raise TopicError(f"{type_name} has no column {name!r}", topic=topic)


@dataclass(frozen=True)
class RunMetadata:
    """The metadata record `sher3.run` of the contract, section 5.

    Attributes:
        excitation: Name of the command sequence; empty when the run was not scripted.
        repeat: Number of the run among those of the same excitation.
        amplitude: Scale of the excitation.
        payload: Known loads on the tip, rows (from [s], to [s], Fx, Fy, Fz [N in {b}]), counted from the first stamp.
        posture: Name of the posture.
        origin: `plant` or `robot`; empty when a bag does not say.
        seed: Seed of the plant's noise, where there is one.
        extra: Further entries of the record, kept as text.
    """

    excitation: str = ""
    repeat: int = 0
    amplitude: float = 1.0
    payload: tuple[Load, ...] = ()
    posture: str = ""
    origin: str = "plant"
    seed: int | None = None
    extra: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_record(cls, record: Mapping[str, str]) -> RunMetadata:
        """Parse the texts of the metadata record.

        Raises:
            TopicError: an entry does not parse.
        """
        known = {key: record[key] for key in _PARSERS if key in record}
        parsed: dict[str, Any] = {"origin": ""}
        for key, text in known.items():
            try:
                parsed[key] = _PARSERS[key](text)
            except (ValueError, TypeError, RecursionError) as error:
                raise TopicError(
                    f"metadata entry {key!r} does not parse", topic="sher3.run", value=text[:80]
                ) from error
        return cls(**parsed, extra={key: text for key, text in record.items() if key not in _PARSERS})

    def to_record(self) -> dict[str, str]:
        """Return the texts of the metadata record."""
        record = {key: str(getattr(self, key)) for key in ("excitation", "repeat", "amplitude", "posture", "origin")}
        record["payload"] = json.dumps([list(row) for row in self.payload]) if self.payload else "none"
        if self.seed is not None:
            record["seed"] = str(self.seed)
        return {**record, **self.extra}


def _payload(text: str) -> tuple[Load, ...]:
    if text in ("none", ""):
        return ()
    rows = np.array(json.loads(text), dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 5 or not np.isfinite(rows).all():
        raise ValueError("five finite numbers per load")
    return tuple((a, b, x, y, z) for a, b, x, y, z in rows.tolist())


_PARSERS: dict[str, Any] = {
    "excitation": str,
    "repeat": int,
    "amplitude": float,
    "payload": _payload,
    "posture": str,
    "origin": str,
    "seed": int,
}


@dataclass(eq=False)
class Run:
    """One recorded run; `run["measured_js"].position` is a column, `"measured_js" in run` asks for a topic.

    Attributes:
        streams: by topic relative to `/sher3`; a topic that was not recorded is absent.
        metadata: the `sher3.run` record.
        robot_yaml: text of the attached robot.yaml, or None.
        path: where it was read from, or None.
        records: the other metadata records by name (provenance, recording).
        skipped: topics that were not read, with the reason.
    """

    streams: dict[str, Stream]
    metadata: RunMetadata = field(default_factory=RunMetadata)
    robot_yaml: str | None = None
    path: Path | None = None
    records: dict[str, dict[str, str]] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)

    def __getitem__(self, topic: str) -> Stream:
        try:
            return self.streams[topic]
        except KeyError:
            raise MissingTopicError(topic, tuple(self.streams)) from None

    def __contains__(self, topic: object) -> bool:
        return topic in self.streams

    @property
    def start(self) -> int:
        """First stamp of all streams [ns]; 0 for an empty run."""
        return min((int(s.stamp[0]) for s in self.streams.values() if len(s)), default=0)

    @property
    def end(self) -> int:
        """Last stamp of all streams [ns]; 0 for an empty run."""
        return max((int(s.stamp[-1]) for s in self.streams.values() if len(s)), default=0)


def check_run(run: Run, topics: Iterable[str] | None = None) -> None:
    """Refuse a run whose numbers cannot be computed with.

    Checks the named topics; by default the topics of the contract (section 4) that the run has. Commands of the user
    and the streams between mocks are not checked by default: a test may send NaN on purpose.

    Raises:
        MissingTopicError: A named topic is absent.
        StampError: Header stamps repeat or go backwards.
        NotFiniteError: A column holds NaN or infinity.
    """
    for topic in [t for t in CONTRACT_TOPICS if t in run] if topics is None else topics:
        table = run[topic]
        if TYPES[table.type].header:
            _check_stamps(topic, table.stamp)
        for name, column in table.columns.items():
            if isinstance(column, np.ndarray) and not np.isfinite(column).all():
                bad = ~np.isfinite(column.reshape(len(column), -1))
                index = int(np.argmax(bad.any(axis=1)))
                raise NotFiniteError(
                    f"{name} is not finite in {int(bad.sum())} of {column.size} values",
                    topic=topic,
                    index=index,
                    value=float(column.reshape(len(column), -1)[index][bad[index]][0]),
                    remedy="leave the run out, or read it with check=False to look at it",
                )


def _check_stamps(topic: str, stamp: NDArray[np.int64]) -> None:
    step = np.diff(stamp)
    if len(step) and step.min() <= 0:
        index = int(np.argmax(step <= 0)) + 1
        raise StampError(
            f"stamps repeat or go backwards {int((step <= 0).sum())} times, first by {int(step[index - 1])} ns",
            topic=topic,
            index=index,
            value=int(stamp[index]),
            limit=f"> {int(stamp[index - 1])}",
            remedy="leave the run out, or read it with check=False to look at it",
        )
