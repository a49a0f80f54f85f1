"""Every threshold of the machines says what it means and where it comes from; none hides in a comparison."""

import ast
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import pytest

PACKAGES = {"sher3_machines": 1, "sher3_static": 1, "sher3_chain": 12}
"""Packages with a module `thresholds`, and how many it holds at least."""
PLAIN = {-1, 0, 1, 2, 3, 0.5}
"""Numbers that explain themselves in a comparison."""


@pytest.mark.parametrize(("package", "least"), PACKAGES.items())
def test_every_threshold_is_documented(package, least):
    body = ast.parse(Path(import_module(f"{package}.thresholds").__file__).read_text()).body
    named = [(a.targets[0].id, b) for a, b in pairwise(body) if isinstance(a, ast.Assign)]
    assert len(named) >= least
    for name, after in named:
        assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant), name
        assert len(" ".join(str(after.value.value).split())) > 40, name


@pytest.mark.parametrize("package", PACKAGES)
def test_no_comparison_hides_a_number(package):
    hidden = [
        f"{path.name}:{node.lineno}: {side.value}"
        for path in sorted(Path(import_module(package).__file__).parent.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Compare)
        for side in (node.left, *node.comparators)
        if isinstance(side, ast.Constant) and isinstance(side.value, int | float) and side.value not in PLAIN
    ]
    assert hidden == []
