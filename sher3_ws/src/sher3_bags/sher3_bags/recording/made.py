"""A message that no node sends: it follows from what the nodes send."""

from __future__ import annotations

from typing import NamedTuple

from sher3_description import Qos


class Made(NamedTuple):
    """A message made beside the streams: absolute topic name, type, quality of service and CDR bytes."""

    topic: str
    type: str
    qos: Qos
    data: bytes
