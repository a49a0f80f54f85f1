"""What the pages say of `make` is what the Makefile does."""

from __future__ import annotations

import re

from documentation.pages import pages
from sources import ROOT

MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")


def test_every_target_that_a_page_names_is_there():
    named = {target: page for page in pages() for target in re.findall(r"`make ([a-z-]+)", (ROOT / page).read_text())}
    assert {"test", "docs", "demo"} <= named.keys()
    assert not {target: page for target, page in named.items() if not re.search(rf"(?m)^{target}:", MAKEFILE)}


def test_each_part_of_the_tests_ends_with_as_many_slowest_as_are_promised():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert "each of its two parts prints its ten slowest" in text
    assert re.search(r"(?m)^PYTEST := .* --durations 10 ", MAKEFILE)
    assert len(re.findall(r"\$\(PYTEST\)", MAKEFILE)) == 2
