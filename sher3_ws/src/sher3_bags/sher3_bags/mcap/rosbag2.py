"""The rosbag2 folder: `metadata.yaml` beside one `.mcap`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from sher3_description import Qos

from sher3_bags.errors import ForeignBagError
from sher3_bags.mcap.qos import offered_qos_profiles

METADATA = "metadata.yaml"


@dataclass(frozen=True)
class TopicCount:
    """What `metadata.yaml` says about one topic."""

    type: str
    count: int
    qos: Qos


def find_mcap(path: Path) -> Path:
    """Return the `.mcap` of a bag, given the file itself or its rosbag2 folder.

    The folder's only `.mcap` is its recording: `metadata.yaml` repeats what that file holds, and a killed recorder
    leaves none.

    Raises:
        ForeignBagError: there is no `.mcap`, or more than one.
    """
    if not path.exists():
        raise ForeignBagError("no such file or folder", path=path, remedy="give a bag folder or an .mcap file")
    if path.is_file():
        return path
    found = sorted(path.glob("*.mcap"))
    if len(found) != 1:
        remedy = "name one of the files itself" if found else "convert the recording to MCAP"
        raise ForeignBagError("not a bag of one .mcap", path=path, value=len(found), limit=1, remedy=remedy)
    return found[0]


def write_metadata(folder: Path, mcap: str, start: int, end: int, topics: Mapping[str, TopicCount]) -> None:
    """Write `metadata.yaml` (version 9) for one recording; topics by absolute name, times in ns."""
    total = sum(topic.count for topic in topics.values())
    span: dict[str, Any] = {
        "starting_time": {"nanoseconds_since_epoch": start},
        "duration": {"nanoseconds": end - start},
        "message_count": total,
    }
    document = {
        "version": 9,
        "storage_identifier": "mcap",
        "duration": span["duration"],
        "starting_time": span["starting_time"],
        "message_count": total,
        "topics_with_message_count": [_topic(name, topic) for name, topic in topics.items()],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [mcap],
        "files": [{"path": mcap, **span}],
        "custom_data": None,
        "ros_distro": "jazzy",
    }
    text = yaml.dump({"rosbag2_bagfile_information": document}, Dumper=_Dumper, sort_keys=False)
    (folder / METADATA).write_text(text, encoding="utf-8")


def _topic(name: str, topic: TopicCount) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": name,
            "type": topic.type,
            "serialization_format": "cdr",
            "offered_qos_profiles": offered_qos_profiles(topic.qos),
            "type_description_hash": "",
        },
        "message_count": topic.count,
    }


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Writes repeated mappings out in full: rosbag2 does not read YAML anchors everywhere."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
