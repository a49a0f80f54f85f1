"""A case made of recordings: what was recorded with one excitation becomes repeats of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sher3_bags import read_run, write_case
from sher3_description import Robot, load_robot

from sher3_gap.errors import CaseError

NEEDED = "drives/measured_js"
"""The stream without which nothing can be diagnosed."""


class Assembled(NamedTuple):
    """One run of the new case: its excitation, the number of the repeat and the recording it comes from."""

    excitation: str
    repeat: int
    bag: Path


def assemble(bags: Sequence[Path], out: Path, robot: Path | None = None) -> list[Assembled]:
    """Write a case of recordings.

    Args:
        bags: recordings of the robot, each a run.
        out: new folder.
        robot: file of the nominal robot; None: that of the first recording.

    Raises:
        CaseError: a recording lacks the drives' readings, was made on another robot, or `out` exists.
        BagError, TopicError: a recording cannot be read.
    """
    runs = [read_run(bag, check=False) for bag in bags]
    for bag, run in zip(bags, runs, strict=True):
        if NEEDED not in run:
            remedy = "record with `sher3 record`, or leave this recording out"
            raise CaseError(f"{bag}: topic {NEEDED} is missing", value=", ".join(sorted(run.streams)), remedy=remedy)
    model = load_robot(robot) if robot is not None else _same_robot(bags, [run.robot_yaml for run in runs])
    seen: Counter[str] = Counter()
    found, named = [], []
    for bag, run in zip(bags, runs, strict=True):
        excitation = run.metadata.excitation or bag.resolve().stem
        metadata = replace(run.metadata, excitation=excitation, repeat=seen[excitation])
        found.append(replace(run, metadata=metadata))
        named.append(Assembled(excitation, seen[excitation], bag))
        seen[excitation] += 1
    write_case(out, found, model)
    return named


def _same_robot(bags: Sequence[Path], texts: Sequence[str | None]) -> Robot:
    """Return the robot of all recordings; raises CaseError where one has none, or another one."""
    robots = []
    for bag, text in zip(bags, texts, strict=True):
        if not text:
            raise CaseError(f"{bag}: holds no robot.yaml", value="none", remedy="give the nominal robot with --robot")
        robots.append(Robot.from_yaml(text))
        if robots[-1].digest() != robots[0].digest():
            remedy = "make a case for each robot, or give the nominal one with --robot"
            raise CaseError(
                f"{bag}: was recorded on another robot",
                value=robots[-1].digest(),
                limit=robots[0].digest(),
                remedy=remedy,
            )
    return robots[0]
