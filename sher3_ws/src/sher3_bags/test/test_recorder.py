"""The recorder core: what it is given is in the bag, what is missing is counted, a killed one loses one chunk."""

import os
import signal
import struct
import subprocess
import sys

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from sher3_bags import BagError, Recorder, RunMetadata, read_run, recover
from sher3_bags.codec.encode import encode
from sher3_bags.errors import TopicError
from sher3_bags.figures.gaps import GapCounter
from sher3_common.samples import DiagnosticSample, TextSample
from sher3_description import TOPICS, load_robot
from sher3_runtime.codec.cdr import codec

ROBOT = load_robot()


def feed(recorder, run, topics=None, skip=()):
    """Hand the messages of a run to a recorder in the order of their log times."""
    order = []
    for topic, table in run.streams.items():
        if topics is None or topic in topics:
            encoded = encode(table)
            log = table.stamp if table.log_time is None else table.log_time
            order += [
                (int(log[k]), topic, encoded.payload[s : s + n].tobytes())
                for k, (s, n) in enumerate(zip(encoded.start, encoded.length, strict=True))
                if (topic, k) not in skip
            ]
    for log_time, topic, data in sorted(order, key=lambda entry: entry[0]):
        recorder.write(topic, data, log_time)


def test_recorded_equals_given(tmp_path, run, same_streams):
    with Recorder(tmp_path / "bag", ROBOT, RunMetadata("demo", origin="robot", seed=3), {"rate": 500}) as recorder:
        feed(recorder, run)
    again = read_run(tmp_path / "bag")
    again.streams = {topic: again[topic] for topic in run.streams}
    same_streams(run, again)
    assert again.metadata == RunMetadata("demo", origin="robot", seed=3)
    assert again.robot_yaml == ROBOT.to_yaml()
    record = again.records["sher3.provenance"]
    assert record["parameters"] == '{"rate": 500}'
    assert record["robot_digest"] == ROBOT.digest()
    assert '"numpy"' in record["versions"]
    assert record["git"]
    assert '"dropped": 0' in again.records["sher3.recording"]["measured_js"]


def test_independent_readers_open_a_recording(tmp_path, run):
    """Also with a type whose definition comes from the installed message files."""
    with Recorder(tmp_path / "bag", ROBOT) as recorder:
        feed(recorder, run)
        # Header with stamp 1 s and empty frame, no status entries.
        recorder.write("diagnostics", bytes((0, 1, 0, 0)) + struct.pack("<iIIBxxxI", 1, 0, 1, 0, 0), 5)
        counts = recorder.counts()
    with AnyReader([tmp_path / "bag"]) as reader:
        found = {topic: info.msgcount for topic, info in reader.topics.items()}
        messages = {c.topic: reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages()}
    assert found == {TOPICS[name].recorded_name: entry["messages"] for name, entry in counts.items()}
    assert messages["/diagnostics"].status == []
    assert messages["/sher3/operating_state"].data == "ENABLED, größer"
    with (tmp_path / "bag" / "bag.mcap").open("rb") as file:
        mcap = make_reader(file, validate_crcs=True)
        assert sum(1 for _ in mcap.iter_messages()) == sum(found.values())
        assert [m.name for m in mcap.iter_metadata()] == ["sher3.run", "sher3.provenance", "sher3.recording"]
    assert read_run(tmp_path / "bag").skipped == {"/diagnostics": "outside /sher3"}


def test_drops_are_counted_per_source_and_kept_in_the_bag(tmp_path, run):
    gone = {("measured_js", k) for k in (10, 11, 12, 50)} | {("servo_jv", 399)}
    with Recorder(tmp_path / "bag", ROBOT) as recorder:
        feed(recorder, run, skip=gone)
        counts = recorder.counts()
    assert counts["measured_js"]["dropped"] == 4
    assert counts["measured_js"]["longest"] == 8_000_000
    # The last sample of a source is missing without a gap: nothing came after it.
    assert {topic for topic, entry in counts.items() if entry["dropped"]} == {"measured_js"}
    assert '"dropped": 4' in read_run(tmp_path / "bag").records["sher3.recording"]["measured_js"]


def test_gap_counter():
    gaps = GapCounter(period=2_000_000)
    for stamp in (0, 2, 4, 10, 10, 8, 12, 400, 402):
        gaps.see(stamp * 1_000_000)
    assert gaps.counts() == {"messages": 9, "dropped": 2, "pauses": 1, "disordered": 2, "longest": 388_000_000}


def test_reports_of_many_nodes_are_not_out_of_order(tmp_path):
    pack = codec("diagnostic_msgs/msg/DiagnosticArray").encode
    with Recorder(tmp_path / "bag", ROBOT) as recorder:
        for count, (stamp, name) in enumerate(((20, "pedal"), (20, "plant"), (10, "supervisor"))):
            recorder.write("diagnostics", pack(DiagnosticSample(stamp, name, 0, "ok")), 100 + count)
        assert recorder.counts()["diagnostics"]["disordered"] == 0


def test_bad_input(tmp_path, run):
    recorder = Recorder(tmp_path / "bag", ROBOT)
    with pytest.raises(TopicError, match="no such topic"):
        recorder.write("measured", b"", 0)
    recorder.close()
    recorder.close()
    with pytest.raises(BagError, match="recording is complete"):
        recorder.write("measured_js", b"", 0)
    with pytest.raises(BagError, match="exists already"):
        Recorder(tmp_path / "bag", ROBOT)
    assert read_run(tmp_path / "bag").streams == {}


def test_recorded_messages_are_kept_even_when_they_are_garbage(tmp_path):
    with Recorder(tmp_path / "bag", ROBOT) as recorder:
        recorder.write("measured_js", b"\x00", 1)
    with pytest.raises(TopicError, match="measured_js, message 0"):
        read_run(tmp_path / "bag")


def test_a_full_disk_is_said_and_what_was_written_is_recovered(tmp_path, build, fill_disk):
    recorder = Recorder(tmp_path / "bag", ROBOT)
    feed(recorder, build(300))
    fill_disk(recorder)
    with pytest.raises(BagError, match="cannot be written: No space left"):
        feed(recorder, build(3000, start=1_800_000_000_000_000_000))
    recovery = recover(tmp_path / "bag")
    assert len(read_run(recovery.target)["measured_js"]) == 300


KILLED = """
import struct, sys, time
from pathlib import Path
from sher3_bags import Recorder
from sher3_description import load_robot
recorder = Recorder(Path(sys.argv[1]), load_robot())
k = 0
while True:
    t = 1_000_000_000 + 2_000_000 * k
    stamp = struct.pack("<iI", *divmod(t, 1_000_000_000))
    recorder.write("temperature", bytes((0, 1, 0, 0)) + stamp + struct.pack("<IIdd", 1, 0, k, 0.0), t)
    print(k, flush=True)
    k += 1
"""


def test_kill_9_loses_at_most_the_last_chunk(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path / "bag")], stdout=subprocess.PIPE, text=True)
    written = 0
    while written < 3000:
        written = int(child.stdout.readline())
    os.kill(child.pid, signal.SIGKILL)
    written = max(written, *map(int, child.communicate()[0].split()), 0)
    recovery = recover(tmp_path / "bag")
    table = read_run(recovery.target)["temperature"]
    assert table.temperature.tolist() == list(range(len(table)))
    # One chunk holds 0.5 s of this source, which is 250 samples.
    assert written - 251 <= len(table) <= written + 1


def test_texts_that_arrive_together_are_not_out_of_order(tmp_path):
    """They bear no stamp, and in stepped time several arrive at one instant; a clock that goes back is disorder."""
    pack = codec("std_msgs/msg/String").encode
    with Recorder(tmp_path / "bag", ROBOT) as recorder:
        for arrived in (100, 100, 200, 150):
            recorder.write("mock/fault", pack(TextSample("{}")), arrived)
        assert recorder.counts()["mock/fault"]["disordered"] == 1
