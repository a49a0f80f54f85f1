"""The matrix as a whole: its cells in groups over processes, its verdicts, its report."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from sher3_bringup.errors import ConfigurationError
from sher3_common import make_folder
from sher3_description import Robot, load_robot

from sher3_safety.measurement.recording import Outcome
from sher3_safety.measurement.report import as_markdown, as_text, misses, nearest_to_budget
from sher3_safety.measurement.verdict import Verdict, judge
from sher3_safety.rows.processes import WALL, WALL_STATES
from sher3_safety.rows.row import Row, select
from sher3_safety.rows.stepped import ROWS, in_one_process
from sher3_safety.runs.stepped import Cell, run_cells

COMMAND, WALL_OPTION = "sher3 safety", " --wall"


@dataclass
class MatrixResult:
    """What came of a run of the matrix.

    Attributes:
        verdicts: of every cell, in order.
        command: that prints it, for the report.
        seed: of noise and faults.
        false_trips: of healthy running, where it was asked for.
    """

    verdicts: Sequence[Verdict]
    command: str
    seed: int
    false_trips: dict[str, Any] | None = field(default=None)

    @property
    def missed(self) -> bool:
        """Whether a cell misses."""
        return not all(verdict.holds for verdict in self.verdicts)

    def notes(self) -> list[str]:
        """Return what stands above the table."""
        held = sum(verdict.holds for verdict in self.verdicts)
        lines = [f"`{self.command}`, seed {self.seed}: {held} of {len(self.verdicts)} cells hold."]
        lines += [nearest] if (nearest := nearest_to_budget(self.verdicts)) else []
        lines.append(f"Not in this run: {self.left_out()}.")
        if self.false_trips is not None:
            f = self.false_trips
            lines.append(
                f"False trips: {f['trips']} in {f['hours'] * 60:.1f} min of healthy running, "
                f"{f['per_hour']:.1f} per hour (95 % bound {f['upper_95']:.0f})."
            )
        return lines

    def left_out(self) -> str:
        """Return what this run did not measure."""
        stepped, wall = sum(len(row.states) for row in ROWS), len(WALL) * len(WALL_STATES)
        kinds = {"": ("stepped", stepped), WALL_OPTION: ("wall", wall)}
        mine = WALL_OPTION if WALL_OPTION in self.command else ""
        left = {option: number - (len(self.verdicts) if option == mine else 0) for option, (_, number) in kinds.items()}
        cells = [f"{left[option]} cells in {time} time (`{COMMAND}{option}`)" for option, (time, _) in kinds.items()
                 if left[option] > 0]  # fmt: skip
        return ", ".join([*cells, "real drives, sensor and pedal"])

    def as_text(self) -> str:
        """Return the table with its misses, for a terminal."""
        return "\n".join([as_text(self.verdicts), "", *misses(self.verdicts), *self.notes()])

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        cells = [verdict.to_dict() for verdict in self.verdicts]
        return {"command": self.command, "seed": self.seed, "cells": cells, "false_trips": self.false_trips}

    def write(self, folder: Path) -> None:
        """Write report.md and report.json."""
        make_folder(folder)
        text = as_markdown("Faults, and how far the tip travels", self.verdicts, self.notes())
        (folder / "report.md").write_text(text, encoding="utf-8")
        (folder / "report.json").write_text(json.dumps(self.to_dict(), indent=1), encoding="utf-8")


def run_matrix(
    folder: Path,
    *,
    only: str = "",
    quick: bool = False,
    seed: int = 1,
    jobs: int = 1,
    say: Callable[[str], None] = lambda _: None,
    robot: Robot | None = None,
    composed: bool = False,
) -> MatrixResult:
    """Run the matrix in stepped time; bags go to `folder/<component>`.

    Args:
        folder: of bags and report.
        only: components whose name begins so.
        quick: the compact set.
        seed: of noise and faults.
        jobs: processes at a time.
        say: prints progress.
        robot: nominal by default.
        composed: the nodes of the loop share a process, and stop together.

    Raises:
        ConfigurationError: no component's name begins so.
    """
    robot = robot or load_robot()
    rows = list(select(in_one_process(ROWS) if composed else ROWS, only, quick))
    if not rows:
        known = ", ".join(dict.fromkeys(row.component for row in ROWS))
        raise ConfigurationError("no such component in the matrix", value=only, limit=known, remedy="choose one")
    groups = {"compact": rows} if quick else _by_component(rows)
    found: dict[str, Outcome] = {}
    for name, outcomes in _run_groups(groups, robot, folder, seed, jobs, composed):
        found.update(outcomes)
        say(f"{name}: {len(outcomes)} cells measured")
    verdicts = [judge(row, state, found.get(row.label(state))) for row in rows for state in row.states]
    options = (f" --only {only}" if only else "") + " --quick" * quick + " --composed" * composed
    return MatrixResult(verdicts, COMMAND + options, seed)


def _by_component(rows: Iterable[Row]) -> dict[str, list[Row]]:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.component, []).append(row)
    return groups


def _run_groups(
    groups: dict[str, list[Row]], robot: Robot, folder: Path, seed: int, jobs: int, composed: bool
) -> Iterable[tuple[str, dict[str, Outcome]]]:
    cells: dict[str, list[Cell]] = {
        name: [(row, state) for row in rows for state in row.states] for name, rows in groups.items()
    }
    if jobs == 1:
        for name, part in cells.items():
            yield name, run_cells(name, part, robot, folder, seed, composed)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        futures = {
            name: pool.submit(run_cells, name, part, robot, folder, seed, composed) for name, part in cells.items()
        }
        for name, future in futures.items():
            yield name, future.result()
