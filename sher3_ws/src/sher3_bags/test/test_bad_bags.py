"""Foreign, damaged and wrong bags: a typed error that carries its numbers, never a wrong array."""

import struct
import zlib
from dataclasses import replace

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType, Writer
from sher3_bags import Run, check_run, read_case, read_run, stream, write_case, write_run
from sher3_bags.codec.encode import encode
from sher3_bags.errors import (
    CaseError,
    DamagedBagError,
    ForeignBagError,
    LimitError,
    MalformedMessageError,
    MissingTopicError,
    NotFiniteError,
    StampError,
    TopicError,
    WrongTypeError,
)
from sher3_bags.messages import schema_text
from sher3_common import Sher3Error
from sher3_description import load_robot


def messages(table):
    encoded = encode(table)
    return [encoded.payload[s : s + n].tobytes() for s, n in zip(encoded.start, encoded.length, strict=True)]


def write_raw(path, topic, type_name, data, compression=CompressionType.NONE, chunked=True, definition=None):
    """Write messages with the mcap package's own writer."""
    with path.open("wb") as file:
        writer = Writer(file, compression=compression, use_chunking=chunked)
        writer.start("ros2", "test")
        text = schema_text(type_name) if definition is None else definition
        schema = writer.register_schema(type_name, "ros2msg", text.encode())
        channel = writer.register_channel(topic, "cdr", schema)
        for k, raw in enumerate(data):
            writer.add_message(channel, 1_000_000 * k, raw, 1_000_000 * k)
        writer.finish()
    return path


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD])
@pytest.mark.parametrize("chunked", [True, False])
def test_every_compression_and_no_chunks(tmp_path, run, compression, chunked):
    data = messages(run["measured_js"])
    path = write_raw(
        tmp_path / "a.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", data, compression, chunked
    )
    again = read_run(path)
    assert np.array_equal(again["measured_js"].position, run["measured_js"].position)


def test_varying_layout_is_decoded_singly(tmp_path, run):
    """Padding may hold anything, byte order may differ: the columns are the same."""
    data = messages(run["measured_js"])
    first = bytearray(data[1])
    first[17:20] = b"\xaa\xbb\xcc"  # behind the empty frame_id
    data[1] = bytes(first)
    path = write_raw(tmp_path / "a.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", data)
    assert np.array_equal(read_run(path)["measured_js"].position, run["measured_js"].position)
    data[2] = data[2] + b"\0\0\0\0"  # trailing padding: another length
    path = write_raw(tmp_path / "b.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", data)
    assert np.array_equal(read_run(path)["measured_js"].position, run["measured_js"].position)


def test_big_endian(tmp_path):
    data = [b"\x00\x00\x00\x00" + struct.pack(">iIIxxxxdd", 5, k, 1, 20.0 + k, 0.0) for k in range(3)]
    path = write_raw(tmp_path / "a.mcap", "/sher3/temperature", "sensor_msgs/msg/Temperature", data)
    table = read_run(path)["temperature"]
    assert table.temperature.tolist() == [20.0, 21.0, 22.0]
    assert table.stamp.tolist() == [5 * 10**9, 5 * 10**9 + 1, 5 * 10**9 + 2]


def test_texts(tmp_path):
    def text(content: bytes, order: str = "<") -> bytes:
        return (b"\0\1" if order == "<" else b"\0\0") + b"\0\0" + struct.pack(order + "I", len(content)) + content

    kind, topic = "std_msgs/msg/String", "/sher3/operating_state"
    data = [text(b"ENABLED\0"), text("größer\0".encode()), text(b"\0") + bytes(3), text(b"PAUSED\0", ">")]
    expected = ("ENABLED", "größer", "", "PAUSED")
    for last in (3, 4):  # all little endian, then mixed
        path = write_raw(tmp_path / "a.mcap", topic, kind, data[:last])
        assert read_run(path)["operating_state"].data == expected[:last]
    for bad in (b"", b"\0\1\0\0", text(b"\xff\0"), text(b"cut\0")[:-1]):
        path = write_raw(tmp_path / "b.mcap", topic, kind, [data[0], bad])
        with pytest.raises(MalformedMessageError, match="operating_state, message 1"):
            read_run(path)


def test_joints_in_another_order_are_sorted(tmp_path, run, monkeypatch):
    order = ("tilt", "roll", "delta_3", "delta_2", "delta_1")
    monkeypatch.setattr("sher3_bags.codec.encode.ACTUATORS", order)
    data = messages(run["measured_js"])
    monkeypatch.undo()
    path = write_raw(tmp_path / "a.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", data)
    assert np.array_equal(read_run(path)["measured_js"].position, run["measured_js"].position[:, ::-1])
    other = [raw.replace(b"roll", b"rool") for raw in data]
    path = write_raw(tmp_path / "b.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", other)
    with pytest.raises(MalformedMessageError, match=r"unknown joints.*rool"):
        read_run(path)
    path = write_raw(tmp_path / "c.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", [*data, other[0]])
    with pytest.raises(MalformedMessageError, match=r"message 400: .*change within the run"):
        read_run(path)


def test_foreign_files(tmp_path, run):
    with pytest.raises(ForeignBagError, match="no such file"):
        read_run(tmp_path / "missing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ForeignBagError, match=r"not a bag of one \.mcap; value 0; limit 1"):
        read_run(tmp_path / "empty")
    (tmp_path / "text.mcap").write_text("not a bag")
    with pytest.raises(ForeignBagError, match="not an MCAP file"):
        read_run(tmp_path / "text.mcap")
    (tmp_path / "zero.mcap").write_bytes(b"")
    with pytest.raises(ForeignBagError, match="empty"):
        read_run(tmp_path / "zero.mcap")
    raw = messages(run["measured_js"])
    path = write_raw(tmp_path / "other.mcap", "/turtle/pose", "sensor_msgs/msg/JointState", raw)
    with pytest.raises(ForeignBagError, match="/turtle/pose"):
        read_run(path)


def test_wrong_type_or_definition(tmp_path, run):
    raw = messages(run["measured_js"])
    path = write_raw(tmp_path / "a.mcap", "/sher3/measured_cp", "sensor_msgs/msg/JointState", raw)
    with pytest.raises(WrongTypeError, match=r"measured_cp: wrong type; value sensor_msgs/msg/JointState"):
        read_run(path)
    other = schema_text("sensor_msgs/msg/JointState").replace("float64[] velocity", "float32[] velocity")
    path = write_raw(tmp_path / "b.mcap", "/sher3/measured_js", "sensor_msgs/msg/JointState", raw, definition=other)
    with pytest.raises(WrongTypeError, match="another definition"):
        read_run(path)


@pytest.mark.parametrize("cut", [0, 3, 11, 16, 19, 40, 60, 100])
def test_short_messages(tmp_path, run, cut):
    raw = messages(run["drives/measured_js"])
    raw[3] = raw[3][:cut]
    path = write_raw(tmp_path / "a.mcap", "/sher3/drives/measured_js", "sensor_msgs/msg/JointState", raw)
    with pytest.raises(MalformedMessageError) as caught:
        read_run(path)
    assert (caught.value.topic, caught.value.index) == ("drives/measured_js", 3)


def test_huge_counts_in_a_message(tmp_path, run):
    raw = messages(run["drives/measured_js"])
    broken = bytearray(raw[0])
    broken[20:24] = b"\xff\xff\xff\xff"
    path = write_raw(tmp_path / "a.mcap", "/sher3/drives/measured_js", "sensor_msgs/msg/JointState", [bytes(broken)])
    with pytest.raises(MalformedMessageError, match="4294967295"):
        read_run(path)


def test_stamps_and_values(tmp_path, run):
    table = run["measured_js"]
    stamp = table.stamp.copy()
    stamp[7] = stamp[6]
    run.streams["measured_js"] = replace(table, stamp=stamp)
    path = write_run(tmp_path / "stamps", run)
    with pytest.raises(StampError, match=r"measured_js, message 7: stamps repeat or go backwards 1 times") as caught:
        read_run(path)
    assert caught.value.value == stamp[7]
    assert len(read_run(path, check=False)["measured_js"]) == 400
    position = table.position.copy()
    position[9, 2] = np.nan
    run.streams["measured_js"] = replace(table, columns={"position": position})
    with pytest.raises(NotFiniteError, match=r"measured_js, message 9: position is not finite in 1 of 2000 values"):
        read_run(write_run(tmp_path / "nan", run))
    command = stream("command/servo_jp", [5, 5], position=np.full((2, 5), np.nan))
    check_run(Run({"command/servo_jp": command}))
    with pytest.raises(StampError, match="command/servo_jp"):
        check_run(Run({"command/servo_jp": command}), ["command/servo_jp"])
    with pytest.raises(MissingTopicError, match="no topic 'tracker/measured_cp'"):
        check_run(run, ["tracker/measured_cp"])
    with pytest.raises(KeyError):
        run["tracker/measured_cp"]
    with pytest.raises(AttributeError, match="no column 'force'"):
        _ = table.force


def test_errors_are_sher3_errors_and_name_a_remedy(tmp_path):
    with pytest.raises(Sher3Error) as caught:
        read_run(tmp_path / "missing")
    assert caught.value.remedy


def chunk_file(path, compression, body, size, crc=0):
    """Write a file of one chunk with a header of our choice."""
    name = compression.encode()
    content = struct.pack("<QQQII", 0, 0, size, crc, len(name)) + name + struct.pack("<Q", len(body)) + body
    header = struct.pack("<BQII", 1, 8, 0, 0)
    chunk = struct.pack("<BQ", 6, len(content)) + content
    end = struct.pack("<BQI", 15, 4, 0) + struct.pack("<BQQQI", 2, 20, 0, 0, 0)
    path.write_bytes(b"\x89MCAP0\r\n" + header + chunk + end + b"\x89MCAP0\r\n")
    return path


def test_chunks_that_lie(tmp_path):
    path = tmp_path / "a.mcap"
    plain = bytes(1000)
    good = zstandard.compress(struct.pack("<BQ", 3, 1000) + plain)
    with pytest.raises(LimitError, match="a chunk is too large"):
        read_run(chunk_file(path, "zstd", good, 1 << 40))
    with pytest.raises(DamagedBagError, match="does not decompress"):
        read_run(chunk_file(path, "zstd", good, 10))
    with pytest.raises(DamagedBagError, match="does not decompress"):
        read_run(chunk_file(path, "zstd", b"garbage", 1009))
    with pytest.raises(DamagedBagError, match="does not decompress"):
        read_run(chunk_file(path, "lz4", b"garbage", 1009))
    with pytest.raises(DamagedBagError, match="another size"):
        read_run(chunk_file(path, "lz4", lz4.frame.compress(plain), 1009))
    with pytest.raises(DamagedBagError, match="checksum"):
        read_run(chunk_file(path, "", plain, 1000, zlib.crc32(plain) ^ 1))
    with pytest.raises(DamagedBagError, match="broken record"):
        read_run(chunk_file(path, "", struct.pack("<BQ", 5, 1 << 63) + plain, 1009))
    with pytest.raises(ForeignBagError, match="unknown chunk compression"):
        read_run(chunk_file(path, "br", plain, 1000))
    message = struct.pack("<BQHIQQ", 5, 22, 9, 0, 0, 0)
    with pytest.raises(DamagedBagError, match="a channel the file does not declare"):
        read_run(chunk_file(path, "", message, len(message)))


def test_random_damage_never_gives_wrong_numbers(tmp_path, build, same_streams):
    """A flipped byte is refused, or does not touch the data (it sat in an index or in the summary)."""
    run = build(60)
    path = write_run(tmp_path / "a.mcap", run)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    refused = 0
    for at in rng.integers(0, len(whole), 400):
        broken = bytearray(whole)
        broken[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        try:
            again = read_run(path)
        except (DamagedBagError, ForeignBagError, LimitError, TopicError):
            refused += 1
            continue
        same_streams(run, again)
        assert again.metadata == run.metadata
    assert refused > 300


def test_metadata_that_does_not_parse(tmp_path, run):
    run.metadata = replace(run.metadata, extra={"payload": "[[1, 2]]"})
    with pytest.raises(TopicError, match="'payload' does not parse"):
        read_run(write_run(tmp_path / "a", run))


def test_cases(tmp_path, build):
    with pytest.raises(CaseError, match=r"no case\.yaml"):
        read_case(tmp_path)
    with pytest.raises(CaseError, match=r"this is a recording; `sher3 gap case .*bag --out CASE`"):
        read_case(write_run(tmp_path / "bag", build(10)))
    (tmp_path / "log.npz").touch()
    with pytest.raises(CaseError, match=r"a file, no case folder; .*`sher3 gap describe .*log\.npz`"):
        read_case(tmp_path / "log.npz")
    folder = write_case(tmp_path / "case", [build(10)], load_robot())
    file = folder / "case.yaml"
    good = file.read_text()
    for old, new, match in [
        ("sher3.case/1", "sher3.case/9", "not a case file"),
        ("repeat: 2", "repeat: 3", "repeat of run_00 contradicts its bag; value 3; limit 2"),
        ("bag: run_00", "bag: ../case/run_00", "plain name"),
        ("robot: robot.yaml", "robot: /etc/passwd", "plain name"),
        ("runs:", "ruins:", "runs must be a list"),
    ]:
        assert old in good
        file.write_text(good.replace(old, new))
        with pytest.raises(CaseError, match=match):
            read_case(folder)
    file.write_text(good)
    assert len(read_case(folder).runs) == 1
