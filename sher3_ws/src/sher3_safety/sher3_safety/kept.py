"""What earlier calls came to, a line of JSON each, in a file that a later call goes on from."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from sher3_common import parse_json, read_text

MAX_BYTES = 1 << 28
"""Largest file that is gone on from: a million draws."""


class Kept:
    """Lines of a file; without a folder they are forgotten at the end.

    Args:
        folder: where the file is, or is to be.
        name: of the file.
    """

    def __init__(self, folder: Path | None, name: str) -> None:
        self._path = folder and folder / name
        if folder:
            folder.mkdir(parents=True, exist_ok=True)

    def before(self) -> list[Any]:
        """Return what earlier calls have added; raises FileError for a damaged file."""
        if self._path is None or not self._path.exists():
            return []
        return [parse_json(line, self._path) for line in read_text(self._path, MAX_BYTES).splitlines()]

    def add(self, entries: Iterable[Any]) -> None:
        """Keep what was found."""
        if self._path is not None:
            with self._path.open("a", encoding="utf-8") as file:
                file.writelines(f"{json.dumps(entry)}\n" for entry in entries)
