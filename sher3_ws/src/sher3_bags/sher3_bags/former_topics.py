"""Recordings made before `command/rcm` and `command/regime` were topics of their own.

Such a recording carries both on `command/admittance`, told apart by their first word: `rcm here 0.018`, `regime free`.
A reader sees it as if it had been made today: `here 0.018` on `command/rcm`, `free` on `command/regime`. The file
itself is left as it is.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from mcap.records import Channel

from sher3_bags.codec.cdr import TEXT_START
from sher3_bags.mcap.contents import Contents

FORMER = "command/admittance"
MOVED = {b"rcm": "command/rcm", b"regime": "command/regime"}
"""The topic of today by the first word of the text."""

LITTLE_ENDIAN = b"\x00\x01"


def translate_commands(contents: Contents) -> None:
    """Move the texts of `MOVED` in a file in memory to their topics of today; without such texts nothing changes.

    A file that has the topic of today is not an old one, and the text of its `command/admittance` is left alone.
    """
    topics = {channel.topic for channel in contents.channels.values()}
    for former in [channel for channel in contents.channels.values() if channel.topic.endswith("/" + FORMER)]:
        namespace = former.topic.removesuffix(FORMER)
        today = {word: namespace + name for word, name in MOVED.items() if namespace + name not in topics}
        _move(contents, former, today)


def _move(contents: Contents, former: Channel, today: Mapping[bytes, str]) -> None:
    table, texts, end = contents.messages, [], len(contents.buffer)
    ids: dict[bytes, int] = {}
    for row in np.flatnonzero(table.channel == former.id).tolist():
        start, length = int(table.offset[row]), int(table.length[row])
        data = contents.buffer[start : start + length].tobytes()
        word, _, rest = data[TEXT_START:].partition(b" ")
        if word not in today or not data.startswith(LITTLE_ENDIAN):
            continue
        if word not in ids:
            ids[word] = _new_channel(contents, former, today[word])
        text = data[:4] + struct.pack("<I", len(rest)) + rest
        table.channel[row], table.offset[row], table.length[row] = ids[word], end, len(text)
        texts.append(text)
        end += len(text)
    if texts:
        contents.buffer = np.concatenate((contents.buffer, np.frombuffer(b"".join(texts), np.uint8)))


def _new_channel(contents: Contents, former: Channel, topic: str) -> int:
    """Declare a channel of the same type under the lowest number that is free, and return the number."""
    number = next(k for k in range(len(contents.channels) + 1) if k not in contents.channels)
    contents.channels[number] = replace(former, id=number, topic=topic)
    return number
