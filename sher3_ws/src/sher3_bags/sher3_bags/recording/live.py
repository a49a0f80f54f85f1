"""Record what happens in a test or script of one process into a bag named after it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sher3_description import Robot

from sher3_bags.run import RunMetadata

if TYPE_CHECKING:
    from sher3_runtime.execution.graph import Graph

    from sher3_bags.recording.recorder_node import RecorderNode


def bag_folder(name: str, root: Path | None = None) -> Path:
    """Return the folder `bags/<name>`, with characters that a file name cannot hold replaced.

    `root` is by default the `bags` folder of the project this runs in: of the first parent of the working directory
    that has a `pyproject.toml`, or of the working directory itself.
    """
    if root is None:
        here = Path.cwd()
        root = next((p for p in (here, *here.parents) if (p / "pyproject.toml").is_file()), here) / "bags"
    return root / re.sub(r"[^\w.=-]+", "_", name).strip("_")[-120:]


@contextmanager
def recorded(
    graph: Graph,
    name: str,
    *,
    topics: Iterable[str] | None = None,
    robot: Robot | None = None,
    metadata: RunMetadata | None = None,
    root: Path | None = None,
) -> Iterator[RecorderNode]:
    """Record a graph of one process into `bags/<name>`; an earlier bag of that name is replaced.

    The bag is completed however the block ends, so that a failed test leaves it behind:

        with Graph() as graph, recorded(graph, request.node.nodeid) as recorder:
            graph.add(...)
            graph.step(500)
        run = read_run(recorder.recorder.folder)

    Args:
        graph: its nodes may be added before or inside the block.
        name: of the test.
        topics: record only these.
        robot: attached to the bag.
        metadata: the contract's record.
        root: folder of the bags.
    """
    from sher3_bags.recording.recorder_node import RecorderNode

    folder = bag_folder(name, root)
    shutil.rmtree(folder, ignore_errors=True)
    node = graph.add(RecorderNode, folder, robot, topics=topics, metadata=metadata, parameters={"test": name})
    try:
        yield node
    finally:
        node.close()
