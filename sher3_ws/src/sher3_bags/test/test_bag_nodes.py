"""Recorder and replay in a graph of one process and stepped time."""

import numpy as np
import pytest
from sher3_bags import read_run, write_run
from sher3_bags.errors import BagError, DamagedBagError, MissingTopicError, TopicError
from sher3_bags.playback.replay import Replay
from sher3_description import load_robot

pytest.importorskip("sher3_runtime")
pytestmark = pytest.mark.graph

TOPICS = ["setpoint_js", "servo_jv", "measured_js", "force/measured_cf", "operating_state"]


def replay_and_record(folder, replay, topics=None):
    from sher3_bags.playback.replay_node import ReplayNode
    from sher3_bags.recording.recorder_node import RecorderNode
    from sher3_runtime import Graph

    with Graph() as graph:
        recorder = graph.add(RecorderNode, folder, load_robot(), topics=topics or replay.topics)
        player = graph.add(ReplayNode, replay, wait_for=1)
        for _ in range(4000):
            graph.step()
            if player.done:
                break
        graph.until(lambda: sum(recorder.recorder.counts()[t]["messages"] for t in replay.topics) == len(replay))
    return recorder, player


@pytest.mark.parametrize("rate", [0.3, 1.0, 2.0, 7.5, 20.0, 50.0, float("inf")])
def test_what_is_replayed_is_recorded(tmp_path, build, rate):
    path = write_run(tmp_path / "bag", build(200))
    recorder, player = replay_and_record(tmp_path / "again", Replay(path, TOPICS, rate=rate, stamps="keep"))
    assert player.sent == sum(len(read_run(path)[t]) for t in TOPICS)
    one, two = read_run(path), read_run(tmp_path / "again")
    for topic in TOPICS:
        for name, column in one[topic].columns.items():
            assert np.array_equal(column, two[topic].columns[name])
    assert np.array_equal(one["measured_js"].stamp, two["measured_js"].stamp)
    assert recorder.counts["measured_js"]["dropped"] == 0
    span = two["measured_js"].log_time[-1] - two["measured_js"].log_time[0]
    # At infinite rate half a queue (five samples) goes out per tick: 40 ticks for 200 samples.
    assert span == pytest.approx(78_000_000 if np.isinf(rate) else 398_000_000 / rate, abs=2_000_000)


def test_a_rate_beyond_what_a_tick_may_send_is_refused_with_the_fastest_one(tmp_path, build):
    from sher3_bags.playback.replay_node import ReplayNode
    from sher3_runtime import Graph

    path = write_run(tmp_path / "bag", build(200))
    with Graph() as graph, pytest.raises(TopicError, match=r"value 60.*limit 50.*rate of 50 or less, or inf"):
        graph.add(ReplayNode, Replay(path, ["measured_js"], rate=60.0), wait_for=1)


def test_shifted_stamps_stand_on_the_grid(tmp_path, build):
    path = write_run(tmp_path / "bag", build(50))
    replay_and_record(tmp_path / "again", Replay(path, ["measured_js"]))
    stamp = read_run(tmp_path / "again")["measured_js"].stamp
    assert (stamp % 2_000_000 == 0).all()
    assert (np.diff(stamp) == 2_000_000).all()


def test_never_the_second_publisher(tmp_path, build):
    from sher3_bags.playback.replay_node import ReplayNode
    from sher3_runtime import Graph
    from sher3_runtime.execution.graph import Probe

    path = write_run(tmp_path / "bag", build(50))
    with Graph() as graph:
        graph.add(Probe, "servo_jv", name="driver", sends=("servo_jv",))
        graph.add(ReplayNode, Replay(path, ["servo_jv"]), wait_for=1)
        with pytest.raises(TopicError, match="servo_jv: has a publisher already; value driver"):
            for _ in range(500):
                graph.step()


def test_replay_of_bad_input(tmp_path, build):
    path = write_run(tmp_path / "bag", build(50))
    for rate in (0.0, -1.0, float("nan"), 1e-4):
        with pytest.raises(BagError, match="rate must be positive"):
            Replay(path, rate=rate)
    with pytest.raises(MissingTopicError):
        Replay(path, ["tracker/measured_cp"])
    with pytest.raises(BagError, match="nothing to replay"):
        Replay(path, namespace="/other")
    wrong = (path / "bag.mcap").read_bytes().replace(b"/sher3/servo_jv", b"/sher3/servo_cv")
    (tmp_path / "wrong.mcap").write_bytes(wrong)
    with pytest.raises(DamagedBagError):
        Replay(tmp_path / "wrong.mcap")


def test_messages_are_in_order_and_due_in_time(tmp_path, build):
    path = write_run(tmp_path / "bag", build(100))
    replay = Replay(path, rate=4.0)
    due = [message.due for message in replay.messages(1000)]
    assert len(replay) == len(due)
    assert due == sorted(due)
    assert due[0] == 1000
    assert (due[-1] - due[0]) * 1e-9 == pytest.approx(replay.duration)
    assert replay.duration == pytest.approx(0.198 / 4, abs=1e-4)


def test_a_test_leaves_its_bag(tmp_path, request):
    from sher3_bags.recording.live import bag_folder, recorded
    from sher3_common.samples import JointSample
    from sher3_runtime import Graph
    from sher3_runtime.execution.graph import Probe

    name = request.node.nodeid
    for _ in range(2):  # an earlier bag of the same test is replaced
        with pytest.raises(RuntimeError), Graph() as graph, recorded(graph, name, root=tmp_path) as recorder:
            probe = graph.add(Probe, name="driver", sends=("measured_js",))
            graph.step()
            for k in range(5):
                probe.send("measured_js", JointSample(k * 2_000_000 + 1, (0.0, 1.0, 2.0, 3.0, float(k)), None, None))
                graph.settle()
            raise RuntimeError("the test fails")
        folder = recorder.recorder.folder
        assert folder == bag_folder(name, tmp_path)
        run = read_run(folder)
        assert run["measured_js"].position[:, 4].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
        assert run["measured_js"].velocity is None
    assert bag_folder("a/b.py::test_x[1-0.5]").parts[-2:] == ("bags", "a_b.py_test_x_1-0.5")


@pytest.mark.parametrize("required", [True, False])
def test_a_full_disk_is_an_error_in_diagnostics_and_ends_a_required_recording(tmp_path, build, fill_disk, required):
    """Required: the node ends, and with it the run. Optional: it stays and counts; what was written is recovered."""
    from sher3_bags import recover
    from sher3_bags.playback.replay_node import ReplayNode
    from sher3_bags.recording.recorder_node import RecorderNode
    from sher3_runtime import Graph

    path = write_run(tmp_path / "bag", build(1200))
    with Graph() as graph:
        recorder = graph.add(RecorderNode, tmp_path / "again", load_robot(), topics=TOPICS, required=required)
        probe = graph.probe("diagnostics")
        graph.add(ReplayNode, Replay(path, TOPICS), wait_for=1)
        graph.step(300)
        assert {(s.level, s.message) for s in probe.samples["diagnostics"] if "recorder" in s.name} <= {
            (0, "recording")
        }
        fill_disk(recorder.recorder)
        if required:
            with pytest.raises(BagError, match="cannot be written: No space left"):
                graph.step(800)
            graph.settle()
        else:
            graph.step(800)
        report = [s for s in probe.samples["diagnostics"] if s.name == "recorder: bag"][-1]
        assert report.level == 2 and "not recording" in report.message and "No space left" in report.message
        assert required or int(dict(report.values)["unrecorded"]) > 100
    found = read_run(recover(tmp_path / "again").target)
    assert 200 < len(found["measured_js"]) < 1200


def test_the_time_of_a_recording_counts_from_the_first_sample(tmp_path, build, monkeypatch):
    """The robot is found after a second: the recording lasts its 0.2 s all the same. Without a robot it ends."""
    from sher3_bags.playback.replay_node import ReplayNode
    from sher3_bags.recording.recorder_node import RecorderNode
    from sher3_runtime import Graph

    monkeypatch.setattr("sher3_bags.recording.recorder_node.FOUND", 2.0)
    path = write_run(tmp_path / "bag", build(300))
    with Graph() as graph:
        recorder = graph.add(RecorderNode, tmp_path / "again", load_robot(), topics=[*TOPICS, "diagnostics"])
        graph.step(500)
        assert recorder.lasts(0.2)
        graph.add(ReplayNode, Replay(path, TOPICS), wait_for=1)
        while recorder.lasts(0.2):
            graph.step()
    assert len(read_run(tmp_path / "again")["measured_js"]) == pytest.approx(100, abs=3)
    with Graph() as graph:
        alone = graph.add(RecorderNode, tmp_path / "nobody", load_robot(), topics=[*TOPICS, "diagnostics"])
        graph.step(1001)
        assert not alone.lasts(0.2) and alone.lasts(4.0)


def test_a_recorder_that_looked_later_than_its_queues_hold_says_so():
    from sher3_bags.recording.recorder_node import DEPTH, overflow

    assert overflow(DEPTH * 2_000_000, 2_000_000) is None
    assert "held up for 14.0 s, and its queues hold 10.0 s" in overflow(14_000_000_000, 2_000_000)
