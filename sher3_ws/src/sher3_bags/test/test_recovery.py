"""A bag cut anywhere gives back every whole chunk, and says what is lost."""

import struct
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from sher3_bags import BagError, read_run, recover, write_run
from sher3_bags.errors import DamagedBagError, ForeignBagError

NAMES = {
    1: "header",
    3: "schema",
    4: "channel",
    6: "chunk",
    7: "message index",
    9: "attachment",
    12: "metadata",
    15: "data end",
    8: "chunk index",
    11: "statistics",
    10: "attachment index",
    13: "metadata index",
    14: "summary offset",
    2: "footer",
}


def layout(data):
    """List (name, start, end) of the records, and the magics at both ends."""
    spans, at = [("magic", 0, 8)], 8
    while at < len(data) - 8:
        opcode, length = struct.unpack_from("<BQ", data, at)
        spans.append((NAMES[opcode], at, at + 9 + length))
        at += 9 + length
    return [*spans, ("closing magic", at, len(data))]


@pytest.fixture
def whole(tmp_path, build):
    path = write_run(tmp_path / "whole.mcap", build(700))
    return path.read_bytes()


def test_cut_in_every_kind_of_record(tmp_path, whole):
    spans = layout(whole)
    assert {name for name, *_ in spans} == {"magic", "closing magic", *NAMES.values()}
    total = sum(len(s) for s in read_run(tmp_path / "whole.mcap").streams.values())
    chunks = [(start, end) for name, start, end in spans if name == "chunk"]
    assert len(chunks) >= 3
    for name in {name for name, *_ in spans}:
        # The last record of a kind, cut at its first byte, inside its head, in the middle and one byte short.
        _, start, end = [span for span in spans if span[0] == name][-1]
        for at in {start, start + 1, start + 5, (start + end) // 2, end - 1}:
            path = tmp_path / "cut.mcap"
            path.write_bytes(whole[:at])
            if at < 8:
                with pytest.raises(ForeignBagError):
                    recover(path)
                continue
            with pytest.raises(DamagedBagError, match="run `sher3 recover`"):
                read_run(path)
            kept = sum(1 for _, chunk_end in chunks if chunk_end <= at)
            if not kept:
                with pytest.raises(BagError, match="nothing to recover"):
                    recover(path)
                continue
            target = tmp_path / f"{name} {at}"
            recovery = recover(path, target)
            assert recovery.chunks == kept, (name, at)
            again = read_run(target)
            found = sum(len(s) for s in again.streams.values())
            assert found == sum(recovery.messages.values())
            assert found == total or kept < len(chunks)
            assert again.robot_yaml is not None
            assert again.metadata.excitation == "sweep"
            assert "cause" in again.records["sher3.recovery"]


def test_what_remains_is_unchanged(tmp_path, whole, same_streams, build):
    last = [span for span in layout(whole) if span[0] == "chunk"][-1]
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[: last[1] + 100])
    recovery = recover(path)
    assert recovery.target == str(tmp_path / "cut_recovered")
    assert recovery.lost_bytes == 100
    run, again = build(700), read_run(recovery.target)
    for topic, table in again.streams.items():
        n = len(table)
        assert (table.stamp == run[topic].stamp[:n]).all()
        for name, column in run[topic].columns.items():
            assert np.array_equal(table.columns[name], column[:n])


def test_independent_readers_open_what_is_recovered(tmp_path, whole):
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[: len(whole) * 2 // 3])
    recovery = recover(path)
    with AnyReader([Path(recovery.target)]) as reader:
        assert reader.message_count == sum(recovery.messages.values())
        assert sum(reader.deserialize(raw, c.msgtype) is not None for c, _, raw in reader.messages()) > 1000


def test_a_corrupt_chunk_in_the_middle_is_left_out(tmp_path, whole):
    chunks = [span for span in layout(whole) if span[0] == "chunk"]
    broken = bytearray(whole)
    broken[(chunks[1][1] + chunks[1][2]) // 2] ^= 0xFF
    path = tmp_path / "corrupt.mcap"
    path.write_bytes(broken)
    with pytest.raises(DamagedBagError):
        read_run(path)
    recovery = recover(path)
    assert (recovery.chunks, recovery.lost_chunks, recovery.lost_bytes) == (len(chunks) - 1, 1, 0)
    assert "lost 1 chunks inside" in str(recovery)
    read_run(recovery.target)


def test_a_flip_outside_the_chunks_is_found_by_the_checksum_of_the_data(tmp_path, whole):
    at = whole.index(b"/sher3/servo_jv")
    path = tmp_path / "renamed.mcap"
    path.write_bytes(whole[:at] + b"/sher3/servo_jw" + whole[at + 15 :])
    with pytest.raises(DamagedBagError, match="data section fails its checksum"):
        read_run(path)
    recovery = recover(path)
    assert recovery.cause is not None
    assert recovery.lost_chunks == 0


def test_a_whole_bag_is_left_alone(tmp_path, whole):
    recovery = recover(tmp_path / "whole.mcap")
    assert (recovery.cause, recovery.target) == (None, None)
    assert [p.name for p in tmp_path.iterdir()] == ["whole.mcap"]
