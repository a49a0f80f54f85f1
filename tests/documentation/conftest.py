"""Folders in which the commands on the pages run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from documentation.forked_python import ForkedPython
from documentation.inputs import Inputs
from documentation.terminal import Terminal
from sher3_runtime.domains import PROCESSES, claim_domain, release_domain
from sources import ROOT

if str(ROOT / "docs") not in sys.path:
    sys.path.append(str(ROOT / "docs"))

LIMIT = 600.0
"""Seconds that one command may take; what takes longer says so on its page."""


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """One ROS domain for all pages: their robots run one after the other."""
    claimed = claim_domain(PROCESSES)
    yield claimed
    release_domain(claimed)


@pytest.fixture(scope="session")
def command_tree() -> dict:
    """Every command of `sher3` by its full name."""
    from generators.command_line import commands

    return dict(commands())


@pytest.fixture(scope="session")
def forked_python(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ForkedPython]:
    """What stands for `python` and `sher3` where nothing is measured."""
    forked = ForkedPython(tmp_path_factory.mktemp("forked"))
    yield forked
    forked.close()


@pytest.fixture(scope="session")
def open_terminal(domain: int, command_tree: dict, forked_python: ForkedPython) -> Callable[..., Terminal]:
    """Return a function that opens a terminal in a folder; `empty`: in an empty one."""
    takes_domain = {name for name, command in command_tree.items() if any("--domain" in p.opts for p in command.params)}
    return lambda folder, empty=False: Terminal(folder, domain, takes_domain, LIMIT, empty, forked_python)


@pytest.fixture(scope="session")
def inputs(tmp_path_factory: pytest.TempPathFactory, open_terminal) -> Inputs:
    """Recordings, cases and files that the pages speak of."""
    return Inputs(tmp_path_factory.mktemp("inputs"), open_terminal)


@pytest.fixture
def terminal(tmp_path: Path, open_terminal) -> Iterator[Terminal]:
    """A terminal in a folder of the test's own."""
    opened = open_terminal(tmp_path / "page")
    yield opened
    opened.close()
