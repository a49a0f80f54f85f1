"""What the tests across packages share."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from processes import child_environment, sher3_command
from sher3_runtime.domains import PROCESSES, claim_domain, release_domain
from sources import ROOT

os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")


@pytest.fixture
def domain() -> Iterator[int]:
    """A ROS domain of the test's own, on the whole machine."""
    claimed = claim_domain(PROCESSES)
    yield claimed
    release_domain(claimed)


@pytest.fixture
def bag_folder(request: pytest.FixtureRequest) -> Path:
    """A new place under bags/ for the run a test records; the newest of each test stays there."""
    folder = ROOT / "bags" / "tests" / request.node.name.replace("[", "-").replace("]", "").replace("/", "_")
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def sher3(run_sher3):
    """Return `run(*arguments, timeout=...)`, which runs the command line in a process of its own."""
    return run_sher3


@pytest.fixture(scope="session")
def run_sher3():
    """Return what `sher3` returns, for fixtures that live longer than a test."""

    def run(*arguments: str, timeout: float = 60.0, **changes: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            sher3_command(*arguments), env=child_environment(**changes), capture_output=True, text=True, timeout=timeout
        )

    return run
