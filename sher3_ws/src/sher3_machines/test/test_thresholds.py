"""Every threshold of the machines says what it means and where it comes from; none hides in a comparison."""

import ast
from itertools import pairwise
from pathlib import Path

import sher3_machines
from sher3_machines import thresholds

PLAIN = {-1, 0, 1, 2, 3, 0.5}
"""Numbers that explain themselves in a comparison."""


def test_every_threshold_is_documented():
    body = ast.parse(Path(thresholds.__file__).read_text()).body
    named = [(a.targets[0].id, b) for a, b in pairwise(body) if isinstance(a, ast.Assign)]
    assert len(named) >= 12
    for name, after in named:
        assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant), name
        assert len(" ".join(str(after.value.value).split())) > 40, name


def test_no_comparison_hides_a_number():
    hidden = [
        f"{path.name}:{node.lineno}: {side.value}"
        for path in sorted(Path(sher3_machines.__file__).parent.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Compare)
        for side in (node.left, *node.comparators)
        if isinstance(side, ast.Constant) and isinstance(side.value, int | float) and side.value not in PLAIN
    ]
    assert hidden == []
