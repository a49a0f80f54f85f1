"""Committed pages that are written from the sources."""

from __future__ import annotations

from sources import ROOT


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
