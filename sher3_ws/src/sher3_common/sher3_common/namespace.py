"""Where a robot is in the graph: its namespace, from which its frames and joints have their prefix.

Recordings are of `/sher3` whatever the namespace was: a recording is of one robot, and its readers need not ask which.
"""

from __future__ import annotations

import os
import re

from sher3_common.errors import Sher3Error

NAMESPACE = "/sher3"
"""The namespace of recordings, and of a robot that is given no other."""
NAMESPACE_VARIABLE = "SHER3_NAMESPACE"
LONGEST = 24
"""Letters of a namespace: names of mock devices are made of it, and the kernel bounds those."""
SHARED = frozenset({"/tf", "/tf_static"})
"""Topics that all robots of a domain share: their frames have prefixes."""


class BadNamespace(Sher3Error):
    """No name of a namespace."""

    exit_code = 2


def use_namespace(name: str) -> str:
    """Be in this namespace, in this process and in those it starts; return it with its leading slash.

    Raises:
        BadNamespace: not one or more words of letters, digits and `_` between slashes, or too long.
    """
    words = name.strip("/")
    if not re.fullmatch(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", words, re.ASCII) or len(words) > LONGEST:
        limit = f"letters, digits and _ between slashes, at most {LONGEST}"
        raise BadNamespace("no namespace", value=name, limit=limit, remedy="give a name like left")
    os.environ[NAMESPACE_VARIABLE] = f"/{words}"
    return f"/{words}"


def graph_namespace() -> str:
    """Return the namespace of this process's robot in the graph."""
    return os.environ.get(NAMESPACE_VARIABLE) or NAMESPACE


def robot_name() -> str:
    """Return the namespace as one word: `sher3`, `left`, `theatre_left`."""
    return graph_namespace().strip("/").replace("/", "_")


def prefix() -> str:
    """Return what stands before the names of frames and joints: nothing in `/sher3`, `left_` in `/left`."""
    return "" if graph_namespace() == NAMESPACE else f"{robot_name()}_"


def in_graph(recorded: str) -> str:
    """Return where a topic of a recording is in the graph, both with their leading slash."""
    space = graph_namespace()
    return recorded if space == NAMESPACE or recorded in SHARED else space + recorded.removeprefix(NAMESPACE)
