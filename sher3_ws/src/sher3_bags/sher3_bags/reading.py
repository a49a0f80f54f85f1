"""Read a bag into a `Run`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from sher3_description import NAMESPACE, TOPICS

from sher3_bags.codec.decode import Raw, decode
from sher3_bags.contents import read_contents
from sher3_bags.errors import ForeignBagError, TopicError, WrongTypeError
from sher3_bags.mcap.contents import Contents
from sher3_bags.mcap.rosbag2 import find_mcap
from sher3_bags.messages import TYPES, same_definition
from sher3_bags.run import Run, RunMetadata, Stream, check_run

RUN_RECORD = "sher3.run"
ROBOT_FILE = "robot.yaml"


def read_run(
    path: str | Path, topics: Iterable[str] | None = None, *, namespace: str = NAMESPACE, check: bool = True
) -> Run:
    """Read a bag: a rosbag2 folder or an `.mcap` alone.

    Args:
        path: of the folder or the file.
        topics: read only these, named relative to the namespace; those not recorded are absent from the run.
        namespace: of the robot's topics.
        check: refuse stamps that do not increase and values that are not finite (`check_run`).

    Raises:
        BagError: the bag is foreign, damaged or too large.
        TopicError: a topic has the wrong type, does not decode, or (with `check`) its stamps or values are wrong.
    """
    contents = read_contents(find_mcap(Path(path)))
    run = run_from_contents(contents, topics, namespace=namespace)
    run.path = Path(path)
    if check:
        check_run(run)
    return run


def run_from_contents(contents: Contents, topics: Iterable[str] | None = None, *, namespace: str = NAMESPACE) -> Run:
    """Decode the channels under the namespace into streams; other channels are listed in `Run.skipped`."""
    wanted = None if topics is None else set(topics)
    run = Run({}, _metadata(contents), _robot_yaml(contents))
    run.records = {name: entries for name, entries in contents.metadata.items() if name != RUN_RECORD}
    prefix = namespace.rstrip("/") + "/"
    for channel in contents.channels.values():
        if not channel.topic.startswith(prefix):
            run.skipped[channel.topic] = f"outside {namespace}"
            continue
        topic = channel.topic[len(prefix) :]
        if wanted is None or topic in wanted:
            table = _stream(contents, channel.id, topic, run)
            if table is not None:
                run.streams[topic] = table
    if not run.streams and wanted is None and len(contents.messages.channel):
        raise ForeignBagError(
            f"no topic of this robot under {namespace}",
            path=contents.path,
            value=", ".join(run.skipped),
            remedy="name its namespace",
        )
    # In the order of the topic table; others behind, in the order of the file.
    place = {topic: index for index, topic in enumerate(TOPICS)}
    run.streams = dict(sorted(run.streams.items(), key=lambda item: place.get(item[0], len(place))))
    return run


def _stream(contents: Contents, channel_id: int, topic: str, run: Run) -> Stream | None:
    channel = contents.channels[channel_id]
    schema = contents.schemas.get(channel.schema_id)
    found = schema.name if schema else "none"
    if topic in TOPICS and found != TOPICS[topic].type:
        raise WrongTypeError("wrong type", topic=topic, value=found, limit=TOPICS[topic].type)
    if schema is None or found not in TYPES:
        run.skipped[channel.topic] = f"type {found}"
        return None
    if channel.message_encoding != "cdr" or schema.encoding != "ros2msg":
        encodings = f"{channel.message_encoding}, {schema.encoding}"
        raise WrongTypeError("unknown encoding", topic=topic, value=encodings, limit="cdr, ros2msg")
    if not same_definition(schema.data.decode(errors="replace"), found):
        raise WrongTypeError(
            f"another definition of {found}", topic=topic, remedy="record with ROS 2 Jazzy's common_interfaces"
        )
    table = contents.messages
    rows = table.rows(channel_id)
    if not len(rows):
        return None
    if topic in run.streams:
        raise TopicError("recorded on two channels", topic=topic, remedy="record from one publisher")
    raw = Raw(topic, found, contents.buffer, table.offset[rows], table.length[rows], table.log_time[rows])
    return decode(raw)


def _metadata(contents: Contents) -> RunMetadata:
    return RunMetadata.from_record(contents.metadata.get(RUN_RECORD, {}))


def _robot_yaml(contents: Contents) -> str | None:
    data = contents.attachments.get(ROBOT_FILE)
    return None if data is None else data.decode("utf-8", errors="replace")
