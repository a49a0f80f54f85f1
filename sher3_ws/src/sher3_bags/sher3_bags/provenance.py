"""Where a recording comes from: program, versions and machine, as texts for the record `sher3.provenance`."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from collections.abc import Mapping
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from sher3_description import Robot

PROVENANCE_RECORD = "sher3.provenance"


def provenance(robot: Robot | None = None, parameters: Mapping[str, Any] | None = None) -> dict[str, str]:
    """Return commit, versions of every installed wheel, Python, machine, and the parameters in force.

    Args:
        robot: its digest is noted; the file itself is an attachment of the bag.
        parameters: settings of the nodes, plain data.
    """
    record = {
        "git": _commit(Path(__file__).resolve().parent),
        "python": platform.python_version(),
        "machine": f"{platform.system()} {platform.release()} {platform.machine()}, {os.cpu_count()} cores",
        "versions": json.dumps(_versions()),
        "parameters": json.dumps(dict(parameters or {}), default=str, sort_keys=True),
    }
    if robot is not None:
        record["robot_digest"] = robot.digest()
    return record


@cache
def _versions() -> dict[str, str]:
    """Return the version of every installed wheel, read once in a process: there are hundreds of them."""
    packages = (distribution.metadata for distribution in distributions())
    return dict(sorted((one["Name"], one["Version"]) for one in packages if one["Name"]))


@cache
def _commit(folder: Path) -> str:
    """Return the commit of the working tree this package runs from, `-dirty` when it has changes, or `unknown`."""
    command = ["git", "-C", str(folder), "describe", "--always", "--abbrev=40", "--dirty", "--exclude=*"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return answer.stdout.strip()
