"""Committed pages that are written from the sources, and links as a web page of the repository shows them."""

from __future__ import annotations

import re
import subprocess
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import pytest
from documentation.pages import FENCE, pages
from sources import ROOT

LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)\s#]+)(?:#[^)]*)?\)")


def test_the_committed_pages_are_what_the_sources_say(monkeypatch):
    """`make docs` writes them anew, and so does the remedy below."""
    monkeypatch.setenv("COLUMNS", "100")
    from generators import committed_pages

    stale = [
        str(path.relative_to(ROOT))
        for path, text in committed_pages(ROOT / "docs" / "reference").items()
        if not path.is_file() or path.read_text() != text
    ]
    assert not stale, f"not what the sources say: {stale}; `tools/write-reference` writes them, then commit them"


@cache
def tracked() -> frozenset[Path]:
    """Return the files that git knows; none in a copy without git."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    return frozenset(ROOT / name for name in done.stdout.split("\0") if name)


def there(path: Path) -> bool:
    """Return whether a clone has a file or folder."""
    return path.is_dir() or (path in tracked() if tracked() else path.is_file())


@pytest.mark.parametrize("page", [*pages(), "CHANGELOG.md"])
def test_links_lead_to_files_of_the_repository(page):
    """A page that only the built site has is a dead link where the repository is read."""
    text = FENCE.sub("", (ROOT / page).read_text())
    targets = {unquote(name): (ROOT / page).parent / unquote(name) for name in LINK.findall(text)}
    dead = [name for name, path in targets.items() if not there(path.resolve())]
    assert not dead, f"{page}: {dead}"
