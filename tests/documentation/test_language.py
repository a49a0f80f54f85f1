"""The form of the pages: lines that fit a screen, blocks that say what they hold."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documentation.pages import blocks, pages
from sources import ROOT

LONGEST, LONGEST_PAGE = 120, 2000
LANGUAGES = {"sh", "python", "yaml", "toml", "text", "{toctree}"}


@pytest.mark.parametrize("page", pages())
def test_lines_fit_a_screen(page):
    """A row of a table is one line by its nature, and so is what a program prints; everything else is wrapped."""
    printed = {b.line + n for b in blocks(page) if b.language == "text" for n in range(b.text.count("\n"))}
    lines = enumerate((ROOT / page).read_text().splitlines(), start=1)
    long = [n for n, line in lines if len(line) > LONGEST and not line.lstrip().startswith("|")]
    assert not set(long) - printed, f"{page}: {sorted(set(long) - printed)}"


@pytest.mark.parametrize("page", pages())
def test_blocks_name_their_language(page):
    """A block without a language is neither coloured nor tested."""
    assert not [f"{page}:{b.line}" for b in blocks(page) if b.language not in LANGUAGES]
    assert not [
        f"{page}:{b.line}" for b in blocks(page) if b.language == "text" and re.search(r"^sher3 ", b.text, re.M)
    ]


@pytest.mark.parametrize("page", pages())
def test_fences_open(page):
    """With a backtick behind its own, a fence is text, and the next one turns the rest of the page into code."""
    assert not re.findall(r"^```[^`\n]+`.*$", (ROOT / page).read_text(), re.M)


EVERY = [*pages(), *(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/reference/generated/**/*.md"))]
"""Pages that people write and those that are written from the sources."""


@pytest.mark.parametrize("page", EVERY)
def test_a_page_is_read_in_one_go(page):
    """At most 2000 words, tables and blocks among them."""
    words = len((ROOT / page).read_text().split())
    assert words <= LONGEST_PAGE, f"{page}: {words} words; what was measured goes to a page of figures"


@pytest.mark.parametrize("page", sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/archive/*.md")))
def test_the_archive_is_reached(page):
    """From the page whose figures it holds, and not from the menu."""
    text = (ROOT / page).read_text()
    assert text.startswith("---\norphan: true\n")
    assert any(f"archive/{Path(page).name}" in (ROOT / other).read_text() for other in (*pages(), "CHANGELOG.md"))
