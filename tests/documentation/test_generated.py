"""Committed pages that are written from the sources."""

from __future__ import annotations

import sys

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


def test_figures_of_imperfect_machines_are_by_the_weights_in_force(monkeypatch):
    """They take minutes to draw, so that the page says by which weights; the bench prints it anew."""
    monkeypatch.setattr(sys, "path", [str(ROOT / "bench"), *sys.path])
    from imperfect import HEAD, weights

    text = (ROOT / "docs" / "reference" / "odds-imperfect.md").read_text()
    assert text.startswith(HEAD), "not what `bench/imperfect.py table` prints"
    assert weights() in text, "by weights of before: draw and print them again, as the page says"
