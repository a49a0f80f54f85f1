"""What is written reads back bit for bit, here and in independent readers."""

import copy
import pickle

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from sher3_bags import BagError, Case, read_case, read_run, stream, write_case, write_run
from sher3_bags.errors import TopicError
from sher3_bags.messages import TYPES, same_definition, schema_text
from sher3_description import TOPICS, load_robot


@pytest.mark.parametrize("name", ["bag", "bag.mcap"])
def test_round_trip(tmp_path, run, same_streams, name):
    path = write_run(tmp_path / name, run)
    again = read_run(path)
    same_streams(run, again)
    assert again.metadata == run.metadata
    assert again.robot_yaml == run.robot_yaml
    assert again.path == path
    assert np.array_equal(again["measured_js"].log_time, run["measured_js"].log_time)
    assert again["measured_js"].velocity is None
    assert again["operating_state"].data == ("DISABLED", "ENABLED, größer")


def test_a_subset_of_topics(tmp_path, run):
    path = write_run(tmp_path / "bag", run)
    again = read_run(path, ["measured_js", "tracker/measured_cp"])
    assert list(again.streams) == ["measured_js"]
    assert "tracker/measured_cp" not in again


def test_runs_cross_process_boundaries(run, same_streams):
    again = pickle.loads(pickle.dumps(copy.deepcopy(run)))
    same_streams(run, again)
    assert again["measured_js"].velocity is None


def test_other_namespace(tmp_path, run, same_streams):
    path = write_run(tmp_path / "bag", run, namespace="/robot_2/sher3")
    same_streams(run, read_run(path, namespace="/robot_2/sher3"))
    with pytest.raises(BagError, match="no topic of this robot under /sher3"):
        read_run(path)


def test_rosbags_reads_it(tmp_path, run):
    path = write_run(tmp_path / "bag", run)
    with AnyReader([path]) as reader:
        assert reader.message_count == sum(len(s) for s in run.streams.values())
        connections = [c for c in reader.connections if c.topic == "/sher3/drives/measured_js"]
        efforts = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages(connections)]
    assert np.array_equal([m.effort for m in efforts], run["drives/measured_js"].effort)
    assert efforts[0].name == ["delta_1", "delta_2", "delta_3", "roll", "tilt"]
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in efforts]
    assert stamps == run["drives/measured_js"].stamp.tolist()


def test_mcap_tools_read_it(tmp_path, run):
    path = write_run(tmp_path / "bag.mcap", run)
    total = sum(len(s) for s in run.streams.values())
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary.statistics.message_count == sum(1 for _ in reader.iter_messages()) == total
        assert reader.get_header().profile == "ros2"
        assert {c.compression for c in summary.chunk_indexes} == {"zstd"}
        assert max(c.uncompressed_size for c in summary.chunk_indexes) <= 256 << 10
        assert [m.name for m in reader.iter_metadata()] == ["sher3.run"]
        assert [a.name for a in reader.iter_attachments()] == ["robot.yaml"]
        file.seek(0)
        kinds = [type(record).__name__ for record in StreamReader(file, validate_crcs=True).records]
        assert kinds.count("Message") == total
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        decoded = [entry.decoded_message for entry in reader.iter_decoded_messages(["/sher3/force/measured_cf"])]
    assert [m.wrench.force.x for m in decoded] == run["force/measured_cf"].force[:, 0].tolist()
    assert decoded[0].header.frame_id == "f"


def test_metadata_yaml_says_what_rosbag2_needs(tmp_path, run):
    path = write_run(tmp_path / "bag", run)
    info = yaml.safe_load((path / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert (info["version"], info["storage_identifier"], info["relative_file_paths"]) == (9, "mcap", ["bag.mcap"])
    assert info["message_count"] == sum(len(s) for s in run.streams.values())
    names = {t["topic_metadata"]["name"]: t["message_count"] for t in info["topics_with_message_count"]}
    assert names["/sher3/measured_js"] == 400


@pytest.mark.parametrize("type_name", sorted({*TYPES, *(topic.type for topic in TOPICS.values())}))
def test_definitions_are_those_of_the_installed_messages(type_name, monkeypatch):
    schema_text.cache_clear()
    with monkeypatch.context() as without_files:
        without_files.setattr("sys.prefix", "/nowhere")
        ours = schema_text(type_name)
    monkeypatch.setattr("sher3_bags.messages.DEFINITIONS", {})
    schema_text.cache_clear()
    try:
        installed = schema_text(type_name)
    except TopicError:
        pytest.skip("no message files beside this Python")
    finally:
        monkeypatch.undo()
        schema_text.cache_clear()
    assert installed != ours or type_name == "std_msgs/msg/String"
    assert same_definition(installed, type_name)
    assert not same_definition(installed.replace("string", "int32", 1), type_name)


def test_case_round_trip(tmp_path, build, same_streams):
    runs = [build(50, seed=k) for k in range(3)]
    path = write_case(tmp_path / "case", runs, load_robot())
    case = read_case(path)
    assert isinstance(case, Case)
    for one, two in zip(runs, case.runs, strict=True):
        same_streams(one, two)
    assert case.robot == load_robot()
    assert {name: len(group) for name, group in case.by_excitation().items()} == {"sweep": 3}


def test_write_refuses_what_does_not_fit(tmp_path, run):
    path = write_run(tmp_path / "bag", run)
    with pytest.raises(BagError, match="exists already"):
        write_run(path, run)
    write_run(path, run, overwrite=True)
    with pytest.raises(TopicError, match="wrong shape"):
        stream("measured_js", [1, 2], position=np.zeros((2, 4)))
    with pytest.raises(TopicError, match="no column 'effort'"):
        stream("measured_cp", [1, 2], effort=np.zeros((2, 5)))
    with pytest.raises(TopicError, match="no such topic"):
        stream("measured", [1, 2])


@pytest.mark.shared
def test_practice_cases_read_and_agree_with_rosbags(practice):
    cases = sorted(practice.glob("case_*"))
    assert cases
    for folder in cases:
        case = read_case(folder)
        assert len(case.runs) == len(yaml.safe_load((folder / "case.yaml").read_text())["runs"])
        assert all(not run.skipped for run in case.runs)
    run = case.runs[0]
    with AnyReader([run.path]) as reader:
        connections = [c for c in reader.connections if c.topic == "/sher3/tracker/measured_cp"]
        poses = [reader.deserialize(raw, c.msgtype).pose for c, _, raw in reader.messages(connections)]
    orientation = [[p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w] for p in poses]
    assert np.array_equal(orientation, run["tracker/measured_cp"].orientation)


@pytest.mark.shared
def test_practice_run_survives_a_rewrite(practice, tmp_path, same_streams):
    run = read_run(practice / "case_001" / "run_06")
    again = read_run(write_run(tmp_path / "bag", run))
    same_streams(run, again)
    assert again.metadata == run.metadata
    assert again.robot_yaml == run.robot_yaml
