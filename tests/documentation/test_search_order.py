"""What a search of the site shows first: pages that answer a question, before those that are looked up."""

from __future__ import annotations

import json
import shutil
import subprocess

import pytest
from sources import ROOT

NODE = shutil.which("node")
FOUND = [
    ("reference/api/sher3_chain.manipulator.mjcf", 26),
    ("archive/challenge", 15),
    ("reference/arms", 15),
    ("explanation/how-sure", 5),
    ("tutorial/first-gap", 5),
    ("how-to/export-a-verdict", 5),
]
"""Pages with the score that Sphinx gives them: an object of the name, a title, a word of the text."""


@pytest.mark.skipif(NODE is None, reason="no node to run the script of the page with")
def test_a_page_that_answers_a_question_comes_before_those_that_are_looked_up():
    script = (ROOT / "docs" / "search_order.js").read_text()
    rows = [[page, "", "", "", score] for page, score in FOUND]
    program = f"{script}\nconsole.log(JSON.stringify({json.dumps(rows)}.map(Scorer.score)))"
    done = subprocess.run([NODE, "-e", program], capture_output=True, text=True, check=True, timeout=60)
    scores = dict(zip((page for page, _ in FOUND), json.loads(done.stdout), strict=True))
    assert sorted(scores, key=scores.get, reverse=True)[:3] == [page for page, _ in FOUND[:2:-1]]
    assert min(scores, key=scores.get) == "archive/challenge"
