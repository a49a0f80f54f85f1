"""The topic table as a page."""

from __future__ import annotations

from sher3_description.topics import TOPICS

from generators.table import table

INTRODUCTION = """# Topics

Every topic of the graph, from `sher3_description.topics.TOPICS`, where publishers and subscribers take type, frame and
quality of service from. Names are relative to `/sher3`, but for `/diagnostics`, or to another
[namespace](../../how-to/native-ros.md#two-robots-in-one-domain), which gives frames a prefix. *In the graph*: the name
on the wire, where it is not that of recordings; there CRTK's rules hold: commands of the user are at the root, and no
stream of the robot's own bears the name of a command. *Latched*: a late subscriber gets the last message. *Depth* is
the length of the queue in messages.

"""


def page() -> str:
    """Return the page."""
    rows = [
        (
            f"`{topic.name}`",
            f"`{topic.graph}`" if topic.graph else "",
            topic.content,
            f"`{topic.type.split('/')[-1]}`",
            f"`{topic.frame_id}`" if topic.frame_id else "",
            "latched" if topic.qos.durability == "transient_local" else "",
            topic.qos.reliability.replace("_", " "),
            topic.qos.depth,
        )
        for topic in TOPICS.values()
    ]
    return INTRODUCTION + table(("topic", "in the graph", "content", "type", "frame", "", "reliability", "depth"), rows)
