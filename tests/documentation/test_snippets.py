"""Every Python snippet on the pages runs: those of a page one after the other, in one namespace."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from documentation.expected import tolerance, unlike
from documentation.pages import blocks, pages, shown_output

RUNS_NODES = ("rclpy", "sher3_runtime")
"""What a snippet imports that runs nodes; the others need no computer of their own."""


def snippets() -> list[object]:
    found = []
    for page in pages():
        here = [b for b in blocks(page) if b.language == "python" and b.not_run is None and not b.file]
        if here:
            graph = any(name in block.text for block in here for name in RUNS_NODES)
            slow = any(block.tag == "slow" for block in here)
            marks = [*[pytest.mark.graph] * graph, *[pytest.mark.slow] * slow]
            found.append(pytest.param(here, id=page, marks=marks))
    return found


@pytest.mark.parametrize("here", snippets())
@pytest.mark.flaky(reruns=2)
def test_snippets_of_a_page(here, terminal, inputs, forked_python):
    """In a process of their own, in a folder with the recordings they read."""
    text = "\n".join(block.text for block in here)
    inputs.put(terminal.folder, text)
    (terminal.folder / "snippets.py").write_text(text)
    environment = {**os.environ, "MPLBACKEND": "agg"}
    runs_nodes = any(name in text for name in RUNS_NODES)
    done = subprocess.run(
        [sys.executable if runs_nodes else forked_python.folder / "python", "snippets.py"],
        cwd=terminal.folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-3000:]
    for block, output in shown_output(here[0].page):
        if block.language == "python":
            fault = unlike(output.text, done.stdout, tolerance(output))
            assert not fault, f"{output.page}:{output.line}: {fault}\n{done.stdout[-6000:]}"
