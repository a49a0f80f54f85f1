"""A case: the runs of one robot in one condition (contract, section 5)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import yaml
from sher3_common import make_folder, read_yaml
from sher3_common.progress import Say, silent
from sher3_description import Robot, load_robot

from sher3_bags.case_file import CASE_FILE, case_file
from sher3_bags.errors import CaseError
from sher3_bags.reading import ROBOT_FILE, read_run
from sher3_bags.run import Run
from sher3_bags.writing import write_run

SCHEMA = "sher3.case/1"
MAX_RUNS = 10_000


@dataclass(eq=False)
class Case:
    """The runs of one case, in the order of `case.yaml`, and the robot they were recorded on."""

    runs: list[Run]
    robot: Robot
    path: Path | None = None

    def by_excitation(self) -> dict[str, list[Run]]:
        """Return the runs grouped by excitation: the repeats of each."""
        groups: dict[str, list[Run]] = {}
        for run in self.runs:
            groups.setdefault(run.metadata.excitation, []).append(run)
        return groups


def read_case(path: str | Path, topics: Iterable[str] | None = None, *, check: bool = True, say: Say = silent) -> Case:
    """Read a case folder.

    Args:
        path: the folder.
        topics: as for `read_run`.
        check: as for `read_run`.
        say: takes a line of progress, before the first bag is read.

    Raises:
        CaseError: `case.yaml` is missing or wrong, or contradicts the runs.
        BagError, TopicError, InvalidRobot: a run or the robot file is wrong.
    """
    folder = Path(path)
    file = case_file(folder)
    document = read_yaml(file)
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        found = document.get("schema") if isinstance(document, dict) else type(document).__name__
        raise CaseError("not a case file", path=file, value=found, limit=SCHEMA)
    entries = document.get("runs")
    if not isinstance(entries, list) or not 0 < len(entries) <= MAX_RUNS:
        count = len(entries) if isinstance(entries, list) else None
        raise CaseError("runs must be a list", path=file, value=count, limit=f"1 to {MAX_RUNS} runs")
    wanted = None if topics is None else tuple(topics)
    robot = load_robot(_inside(folder, file, document.get("robot")))
    say("reading the bags")
    return Case([_read_entry(folder, file, entry, wanted, check) for entry in entries], robot, folder)


def _read_entry(folder: Path, file: Path, entry: Any, topics: Sequence[str] | None, check: bool) -> Run:
    if not isinstance(entry, dict):
        raise CaseError("a run is not a mapping", path=file, value=type(entry).__name__)
    run = read_run(_inside(folder, file, entry.get("bag")), topics, check=check)
    for key in ("excitation", "repeat"):
        declared, recorded = entry.get(key), getattr(run.metadata, key)
        if declared != recorded:
            raise CaseError(f"{key} of {entry['bag']} contradicts its bag", path=file, value=declared, limit=recorded)
    return run


def _inside(folder: Path, file: Path, name: object) -> Path:
    if not isinstance(name, str) or PurePosixPath(name).name != name or name in ("", ".", ".."):
        raise CaseError("a file must be named by its plain name", path=file, value=name)
    return folder / name


def write_case(path: str | Path, runs: Sequence[Run], robot: Robot) -> Path:
    """Write runs as a new case folder, bags named `run_00`, `run_01`, …; return its path.

    Raises:
        BagError: something is there already.
    """
    folder = Path(path)
    if folder.exists():
        raise CaseError("exists already", path=folder, remedy="choose another name")
    make_folder(folder)
    (folder / ROBOT_FILE).write_text(robot.to_yaml(), encoding="utf-8")
    entries = []
    for index, run in enumerate(runs):
        name = f"run_{index:02d}"
        write_run(folder / name, run)
        entries.append({"bag": name, "excitation": run.metadata.excitation, "repeat": run.metadata.repeat})
    document = {"schema": SCHEMA, "robot": ROBOT_FILE, "runs": entries}
    (folder / CASE_FILE).write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    return folder
