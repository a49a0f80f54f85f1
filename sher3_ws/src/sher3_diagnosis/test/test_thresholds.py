"""Every threshold says what it means, what it was set on and how to measure it; none is hidden elsewhere."""

import ast
from itertools import pairwise
from pathlib import Path

import sher3_diagnosis
from sher3_diagnosis import thresholds

FOLDER = Path(sher3_diagnosis.__file__).parent
PLAIN = {-1, 0, 1, 2, 3, 0.5}
"""Numbers that explain themselves in a comparison."""


def documented():
    body = ast.parse(Path(thresholds.__file__).read_text()).body
    for before, after in pairwise(body):
        if isinstance(before, ast.Assign):
            text = after.value.value if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) else ""
            yield before.targets[0].id, " ".join(str(text).split())


def test_every_threshold_is_documented():
    found = dict(documented())
    assert len(found) > 35
    for name, text in found.items():
        assert len(text) > 40, name
        says = ("Set on", "Set by", "Set on and measured as", "convention", "Measure:", "by that argument")
        assert any(word in text for word in says) or name in ARGUED, name


ARGUED = {
    "MIN_RUNS": "a resample of four runs has too few distinct ones",
    "JACKKNIFE": "a quantile of Student's t",
    "NORMAL": "a quantile of the normal distribution",
    "REGIME_SAMPLES": "words only",
    "STANDS_OUT": "words only",
    "REGIME_GAP": "words only",
    "LINE_SHARE": "words only",
    "PERIOD_SHARE": "words only",
}
"""Thresholds that follow from an argument in their text, or that only choose words."""


def test_no_comparison_of_the_engine_hides_a_number():
    hidden = []
    for path in sorted(FOLDER.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Compare):
                for side in (node.left, *node.comparators):
                    if (
                        isinstance(side, ast.Constant)
                        and isinstance(side.value, int | float)
                        and side.value not in PLAIN
                    ):
                        hidden.append(f"{path.name}:{node.lineno}: {side.value}")
    assert hidden == []
