"""A newcomer's first hour: tutorials and README in order, in one folder that holds nothing but the environment."""

from __future__ import annotations

import pytest
from documentation.commands import Command, commands
from documentation.expected import unlike
from documentation.pages import Block, blocks
from documentation.terminal import ACTIVATION, Terminal
from documentation.test_commands import follow_block
from sources import ROOT

PAGES = ("docs/tutorial/first-run.md", "docs/tutorial/first-gap.md", "docs/tutorial/first-own-machine.md", "README.md")
OWN = ("robot.xml", "log.npz")
"""What the reader brings: a model and a log of another robot."""
DEMO = "\t$(BIN)/sher3 demo\n"
"""What `make demo` runs in an environment that is there already."""


@pytest.mark.slow
@pytest.mark.graph
@pytest.mark.timeout(1800)
@pytest.mark.flaky(reruns=1)
def test_tutorials_and_readme_in_order_in_one_empty_folder(tmp_path, open_terminal, inputs):
    terminal = open_terminal(tmp_path / "new", empty=True)
    try:
        for page in PAGES:
            if page == "README.md":
                inputs.put(terminal.folder, " ".join(OWN))
            python = [block for block in blocks(page) if block.language == "python" and not block.file]
            for block in blocks(page):
                _follow(block, terminal, (terminal.folder / "bags" / "demo").exists())
            if python:
                (terminal.folder / "page.py").write_text("\n".join(block.text for block in python))
                terminal.run(Command("python page.py"))
            terminal.interrupt()
        assert (terminal.folder / "bags" / "demo" / "summary.html").stat().st_size > 10_000
    finally:
        terminal.close()


def _follow(block: Block, terminal: Terminal, demo_ran: bool) -> None:
    """Do what a block says; `make demo` and the activation too, which other tests leave out."""
    if block.not_run is None:
        follow_block(block, terminal)
        return
    for command in commands(block):
        if command.line == "make demo" and not demo_ran:
            assert DEMO in (ROOT / "Makefile").read_text()
            said = terminal.run(Command(".venv/bin/sher3 demo"))
            assert not unlike("the robot was enabled, moved in every step that asked for it and ...", said), said
        elif command.line.startswith(ACTIVATION):
            terminal.run(command)
