"""Pages of the reference that are written from the sources: a module for a page or a folder of them; `write_pages`."""

from __future__ import annotations

import shutil
from pathlib import Path

from generators import api, commands, effects, front, hazards, robot_file, targets, thresholds, topics

PAGES = {
    "hazards": hazards.page,
    "robot-file": robot_file.page,
    "topics": topics.page,
}
FOLDERS = {
    "commands": commands.pages,
    "effects": effects.pages,
    "targets": targets.pages,
    "thresholds": thresholds.pages,
}
"""What is too much for one page: an index of the folder's name, and in the folder the pages that it links to."""
ORPHAN = "---\norphan: true\n---\n\n"
"""Of a page that an index links to and that stands in no menu."""


def committed_pages(reference: Path) -> dict[Path, str]:
    """Return the pages that are committed, by their paths: below the folder `reference`, and the front page."""
    generated = reference / "generated"
    found = {generated / f"{name}.md": page() for name, page in PAGES.items()}
    for folder, pages in FOLDERS.items():
        index, parts = pages()
        found[generated / f"{folder}.md"] = index
        found |= {generated / folder / f"{part}.md": ORPHAN + text for part, text in parts.items()}
    readme = reference.parents[1] / "README.md"
    return found | {readme: front.page(reference / "told.md", readme)}


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
