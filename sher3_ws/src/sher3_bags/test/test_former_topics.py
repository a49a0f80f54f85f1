"""Recordings that carry remote centre and speed regime on `command/admittance` read as if they were made today."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_bags import Run, RunMetadata, read_run, stream, write_run
from sher3_bags.codec.decode import Raw, decode
from sher3_bags.playback.replay import Replay

FORMER, RCM, REGIME = "command/admittance", "command/rcm", "command/regime"
START = 1_700_000_000_000_000_000
TEXTS = ["speed_scale 0.5", "rcm here 0.018", "regime near_tissue", "rcm", "axis_lock free", "rcm off", "regime free"]


def write_texts(path, **texts):
    """Write a bag whose k-th text of each topic is recorded k ms after the start."""
    streams = {}
    for topic, data in texts.items():
        times = START + np.arange(len(data)) * 1_000_000
        streams[f"command/{topic}"] = stream(f"command/{topic}", times, data=data)
    return write_run(path, Run(streams, RunMetadata(), None))


def test_each_text_is_on_its_topic_of_today_at_its_own_time(tmp_path):
    run = read_run(write_texts(tmp_path / "bag", admittance=TEXTS))
    assert run[FORMER].data == ("speed_scale 0.5", "rcm", "axis_lock free")
    assert run[RCM].data == ("here 0.018", "off")
    assert run[REGIME].data == ("near_tissue", "free")
    assert (run[RCM].log_time - START).tolist() == [1_000_000, 5_000_000]
    assert (run[REGIME].log_time - START).tolist() == [2_000_000, 6_000_000]


def test_only_what_is_asked_for_is_read(tmp_path):
    assert list(read_run(write_texts(tmp_path / "bag", admittance=TEXTS), [RCM]).streams) == [RCM]


def test_a_replay_publishes_each_text_on_its_topic_of_today(tmp_path):
    replay = Replay(write_texts(tmp_path / "bag", admittance=TEXTS))
    assert replay.topics == (FORMER, RCM, REGIME)
    sent = []
    for message in replay.messages(0):
        data = np.frombuffer(message.data, np.uint8)
        raw = Raw(message.topic, "std_msgs/msg/String", data, np.array([0]), np.array([len(data)]), np.array([0]))
        sent.append((message.due, message.topic, decode(raw).data[0]))
    assert sent[:3] == [
        (0, FORMER, "speed_scale 0.5"),
        (1_000_000, RCM, "here 0.018"),
        (2_000_000, REGIME, "near_tissue"),
    ]
    assert len(sent) == len(TEXTS)


def test_a_recording_of_today_is_left_alone(tmp_path):
    """Somebody may still send the former text; it is refused by the law, and no second remote centre for a reader."""
    run = read_run(write_texts(tmp_path / "bag", admittance=["rcm off"], rcm=["here 0.018"]))
    assert run[FORMER].data == ("rcm off",) and run[RCM].data == ("here 0.018",)


@pytest.mark.parametrize("texts", [["speed_scale 0.5"], ["rcmhere 1"], ["regimes 2"]])
def test_other_texts_stay(tmp_path, texts):
    assert list(read_run(write_texts(tmp_path / "bag", admittance=texts)).streams) == [FORMER]
