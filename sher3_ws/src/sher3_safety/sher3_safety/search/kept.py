"""What a search has tried, a line of JSON each, in a file that a later search goes on from."""

from __future__ import annotations

import json
from pathlib import Path

from sher3_safety.search.trial import Found
from sher3_safety.search.words import read

_EXACT = 17
"""Digits with which a number is written and read as the same one."""


class Kept:
    """The trials of one seed; without a folder they are forgotten at the end.

    Args:
        folder: where the file is, or is to be.
        seed: of the draws, which the file is named after.
    """

    def __init__(self, folder: Path | None, seed: int) -> None:
        self._path = folder and folder / f"draws-{seed}.jsonl"
        if folder:
            folder.mkdir(parents=True, exist_ok=True)

    def before(self) -> list[Found]:
        """Return the trials of earlier searches."""
        there = self._path and self._path.exists()
        return [_read(line) for line in self._path.read_text().splitlines()] if self._path and there else []

    def add(self, found: list[Found]) -> list[Found]:
        """Keep the trials of a round, and return them as they will be read, so that a search goes on as it would."""
        lines = [_line(one) for one in found]
        if self._path:
            with self._path.open("a") as file:
                file.writelines(f"{line}\n" for line in lines)
        return [_read(line) for line in lines]


def _line(found: Found) -> str:
    return json.dumps({"draw": found.draw.line(_EXACT), "travel": found.travel, "reason": found.reason})


def _read(line: str) -> Found:
    data = json.loads(line)
    return Found(read(data["draw"]), data["travel"], data["reason"])
