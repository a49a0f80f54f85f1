"""Pages of the reference that are written from the sources: one module a page, `write_pages` for all of them."""

from __future__ import annotations

import shutil
from pathlib import Path

from generators import api, commands, effects, hazards, robot_file, targets, thresholds, topics

PAGES = {
    "commands": commands.page,
    "effects": effects.page,
    "hazards": hazards.page,
    "robot-file": robot_file.page,
    "targets": targets.page,
    "thresholds": thresholds.page,
    "topics": topics.page,
}


def committed_pages(reference: Path) -> dict[Path, str]:
    """Return the pages below the folder `reference` that are committed, by their paths."""
    return {reference / "generated" / f"{name}.md": page() for name, page in PAGES.items()}


def write_pages(reference: Path) -> None:
    """Write every generated page below the folder `reference`; files whose content is unchanged are left alone."""
    wanted = committed_pages(reference)
    wanted |= {reference / "api" / name: text for name, text in api.pages().items()}
    for folder in (reference / "generated", reference / "api"):
        for path in folder.rglob("*") if folder.is_dir() else ():
            if path.is_file() and path not in wanted:
                path.unlink()
    for path, text in wanted.items():
        if not path.exists() or path.read_text() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)


def remove_pages(reference: Path) -> None:
    """Remove everything `write_pages` made."""
    for name in ("generated", "api"):
        shutil.rmtree(reference / name, ignore_errors=True)
