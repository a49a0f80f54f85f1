"""Our CDR is that of an independent serializer, byte for byte, and survives the way back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore
from sher3_bags import Stream
from sher3_bags.codec.decode import Raw, decode
from sher3_bags.codec.encode import encode
from sher3_bags.messages import TYPES
from sher3_description import ACTUATORS

STORE = get_typestore(Stores.ROS2_JAZZY)
T = STORE.types
WIDTHS = {"position": 3, "orientation": 4, "linear": 3, "angular": 3, "force": 3, "torque": 3}
STAMPED = sorted(name for name, kind in TYPES.items() if kind.header)


def independent(table, k):
    """Serialize message k of a stream with rosbags."""
    header = T["std_msgs/msg/Header"](
        stamp=T["builtin_interfaces/msg/Time"](*divmod(int(table.stamp[k]), 10**9)), frame_id=table.frame_id
    )
    row = {name: column[k] for name, column in table.columns.items()}
    name = table.type.split("/")[-1]
    if name == "JointState":
        empty = np.empty(0)
        fields = [row.get(field, empty) for field in ("position", "velocity", "effort")]
        message = T[table.type](header, list(ACTUATORS), *fields)
    elif name == "Joy":
        message = T[table.type](header, row["axes"], row["buttons"])
    elif name == "Temperature":
        message = T[table.type](header, float(row["temperature"]), float(row["variance"]))
    else:
        parts = [T[f"geometry_msgs/msg/{_part(key)}"](*values) for key, values in row.items()]
        inner = T[f"geometry_msgs/msg/{name.removesuffix('Stamped')}"](*parts)
        message = T[table.type](header, inner)
    return bytes(STORE.serialize_cdr(message, table.type))


def _part(field):
    return {"position": "Point", "orientation": "Quaternion"}.get(field, "Vector3")


@st.composite
def streams(draw):
    type_name = draw(st.sampled_from(STAMPED))
    n = draw(st.integers(1, 4))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    stamp = np.sort(rng.integers(-(2**31) * 10**9, 2**31 * 10**9, n))
    columns = {}
    for field in TYPES[type_name].fields:
        if TYPES[type_name].names and draw(st.booleans()):
            continue
        width = field.count or (5 if TYPES[type_name].names else draw(st.integers(1, 4)))
        raw = rng.bytes(n * width * int(field.code[1]))  # NaN and infinity included
        values = np.frombuffer(raw, field.code).reshape(n, width)
        columns[field.name] = values[:, 0].copy() if field.count == 1 else values.copy()
    frame = draw(st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=9))
    return Stream(type_name, stamp, frame, columns)


@settings(max_examples=150, deadline=None)
@given(streams())
def test_bytes_and_back(table):
    coded = encode(table)
    for k, (start, length) in enumerate(zip(coded.start, coded.length, strict=True)):
        ours, theirs = coded.payload[start : start + length].tobytes(), independent(table, k)
        assert ours == theirs[: len(ours)]
        assert len(theirs) - len(ours) < 4  # rosbags may pad at the end
    again = decode(Raw("topic", table.type, coded.payload, coded.start, coded.length, table.stamp))
    assert np.array_equal(again.stamp, table.stamp)
    assert again.frame_id == table.frame_id
    assert set(again.columns) == set(table.columns)
    for name, column in table.columns.items():
        assert again.columns[name].tobytes() == column.tobytes()
        assert again.columns[name].shape == column.shape


@given(st.sampled_from(sorted(TYPES)), st.binary(max_size=200))
@settings(max_examples=300, deadline=None)
def test_garbage_is_refused_or_decodes(type_name, data):
    from sher3_bags.errors import MalformedMessageError

    buffer = np.frombuffer(data, np.uint8)
    one = np.array([0]), np.array([len(data)]), np.array([0])
    try:
        table = decode(Raw("topic", type_name, buffer, *one))
    except MalformedMessageError as error:
        assert error.index == 0
    else:
        assert len(table) == 1


def test_widths_are_those_of_the_types():
    assert {f.name: f.count for kind in TYPES.values() for f in kind.fields if f.count and f.count > 1} == WIDTHS
    with pytest.raises(KeyError):
        encode(Stream("sensor_msgs/msg/Imu", np.zeros(1, np.int64)))
