"""The form of the pages: lines that fit a screen, blocks that say what they hold, links that lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documentation.pages import FENCE, MADE, blocks, pages
from sources import ROOT

LONGEST = 120
LANGUAGES = {"sh", "python", "yaml", "text", "{toctree}"}
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


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
def test_links_lead_to_files(page):
    """Relative to the page; those to pages that are made from the sources are checked on the built site."""
    text = FENCE.sub("", (ROOT / page).read_text())
    for target in LINK.findall(text):
        if target.startswith(("http:", "https:", "#", "mailto:")):
            continue
        path = (ROOT / page).parent / target.partition("#")[0]
        made = str(Path(ROOT, page).parent.joinpath(target).resolve().relative_to(ROOT)).startswith(MADE)
        assert made or path.exists(), f"{page}: {target}"
