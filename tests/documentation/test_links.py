"""Links as a web page of the repository shows them: files that a clone has, and headings that are there."""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import pytest
from documentation.pages import FENCE, pages
from sources import ROOT

LINK = re.compile(r"\]\((?!https?:|mailto:)([^)\s#]*)(?:#([^)\s]*))?\)")
HEADING = re.compile(r"^#{1,6} +(.+?) *#* *$", re.M)
ROLE = re.compile(r"\{[a-z:]+\}`")
EVERY = [*pages(), "CHANGELOG.md", *(str(p.relative_to(ROOT)) for p in ROOT.glob("docs/reference/generated/**/*.md"))]


@cache
def tracked() -> frozenset[Path]:
    """Return the files that git knows; none in a copy without git."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    return frozenset(ROOT / name for name in done.stdout.split("\0") if name)


def there(path: Path) -> bool:
    """Return whether a clone has a file or folder."""
    return path.is_dir() or (path in tracked() if tracked() else path.is_file())


def prose(page: Path) -> str:
    """Return a page without its blocks of code."""
    return FENCE.sub("", page.read_text())


def place(heading: str) -> str:
    """Return the name that a repository's page gives a heading: small letters, hyphens, no other signs."""
    shown = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", shown.lower()).replace(" ", "-")


@cache
def places(page: Path) -> frozenset[str]:
    """Return the places of a page: its headings, the second of one name with `-1` behind it."""
    seen: Counter[str] = Counter()
    found = set()
    for name in map(place, HEADING.findall(prose(page))):
        found.add(f"{name}-{seen[name]}" if seen[name] else name)
        seen[name] += 1
    return frozenset(found)


def links(page: Path) -> list[tuple[Path, str]]:
    """Return the file and the place that each link of a page leads to."""
    targets = LINK.findall(prose(page))
    return [((page.parent / unquote(name)).resolve() if name else page, unquote(spot)) for name, spot in targets]


@pytest.mark.parametrize("page", EVERY)
def test_links_lead_to_files_of_the_repository(page):
    """A page that only the built site has is a dead link where the repository is read."""
    dead = [str(path) for path, _ in links(ROOT / page) if not there(path)]
    assert not dead, f"{page}: {dead}"


@pytest.mark.parametrize("page", EVERY)
def test_links_lead_to_headings(page):
    """A link to a heading that was renamed leads to the top of the page, and the reader looks for it."""
    to_pages = [(path, spot) for path, spot in links(ROOT / page) if spot and path.suffix == ".md"]
    dead = [f"{path.name}#{spot}" for path, spot in to_pages if spot not in places(path)]
    assert not dead, f"{page}: {dead}"


@pytest.mark.parametrize("page", EVERY)
def test_no_words_are_for_the_site_alone(page):
    """A role such as `{download}` is a link on the site and plain text elsewhere."""
    assert not ROLE.findall(prose(ROOT / page))


def test_headings_get_the_names_of_a_repository():
    """As a web page of a repository names them."""
    assert place("What `sher3 gap` says, and why") == "what-sher3-gap-says-and-why"
    assert place("The [tick](tick.md) of 2 ms") == "the-tick-of-2-ms"
