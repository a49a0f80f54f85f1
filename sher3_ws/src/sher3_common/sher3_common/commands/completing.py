"""What the tab key offers: folders that hold a bag or a case, and words of a list."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

BAG, CASE = "*.mcap", "case.yaml"
"""File by which a folder is known as a bag and as a case."""

Completer = Callable[[str], list[str]]


def folders_with(mark: str) -> Completer:
    """Return a completer of paths that end in a folder holding `mark` (a glob), or in folders to go into."""

    def complete(incomplete: str) -> list[str]:
        typed = Path(incomplete)
        inside = typed if incomplete.endswith("/") else typed.parent
        start = "" if incomplete.endswith("/") else typed.name
        try:
            entries = sorted(entry for entry in inside.iterdir() if entry.name.startswith(start))
        except OSError:
            return []
        return [offer for entry in entries if (offer := _offer(entry, mark)) is not None]

    return complete


def _offer(entry: Path, mark: str) -> str | None:
    if entry.is_dir():
        holds = any(entry.glob(mark))
        return str(entry) if holds else f"{entry}/"
    return str(entry) if entry.match(mark) else None


def words(names: Callable[[], Iterable[str]]) -> Completer:
    """Return a completer of words that start with what is typed; `names` is called when the key is pressed."""
    return lambda incomplete: sorted(name for name in names() if name.startswith(incomplete))
