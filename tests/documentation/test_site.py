"""The site builds without a warning, and nothing on it needs the network or leads nowhere."""

from __future__ import annotations

import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from sources import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


class Page(HTMLParser):
    """What a page loads and what it links to.

    Attributes:
        loads: addresses that a browser fetches by itself: scripts, styles, pictures, fonts.
        links: addresses behind its links.
        anchors: names of its places.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        elif tag == "link" and "href" in values and values.get("rel") not in ("canonical",):
            self.loads.append(values["href"])
        elif "src" in values:
            self.loads.append(values["src"])


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Build the site as `make docs` does, elsewhere; a warning is an error."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E", "-j", "auto", "-d", folder / "trees"]
    done = subprocess.run(
        [*command, ROOT / "docs", folder / "html"], capture_output=True, text=True, timeout=800, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    return folder / "html"


@pytest.fixture(scope="module")
def built(site) -> dict[Path, Page]:
    return {path: Page(path.read_text()) for path in site.rglob("*.html")}


def test_no_page_needs_the_network(site, built):
    """Whoever reads it offline sees all of it; and nobody is told that it is read."""
    assert len(built) > 50
    for path, page in built.items():
        away = [
            address for address in page.loads if urlsplit(address).scheme in ("http", "https") or address[:2] == "//"
        ]
        assert not away, f"{path.relative_to(site)}: {away}"
    for path in site.rglob("*.css"):
        assert "url(http" not in path.read_text().replace("'", "").replace('"', ""), path


def test_no_link_is_dead(site, built):
    """Of links within the site: the page is there, and so is the place on it."""
    for path, page in built.items():
        for address in page.links + page.loads:
            parts = urlsplit(address)
            if parts.scheme or address[:2] == "//":
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            assert target.exists(), f"{path.relative_to(site)}: {address}"
            if parts.fragment and target in built:
                assert unquote(parts.fragment) in built[target].anchors, f"{path.relative_to(site)}: {address}"


def test_the_search_works_from_a_file(site):
    """The index is a script that the page loads, not data that a browser refuses to fetch from a file."""
    assert "searchindex.js" in (site / "search.html").read_text()
    assert (site / "searchindex.js").read_text().startswith("Search.setIndex(")
    assert "backlash" in (site / "searchindex.js").read_text()
    assert "How-to pages first" in (site / "_static" / "searchtools.js").read_text()
