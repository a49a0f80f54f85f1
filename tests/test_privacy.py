"""Tests, benches and tools use what a package shows, not its private members."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from sources import ROOT, SOURCES

READERS = sorted(
    path
    for pattern in ("tests/*.py", "bench/*.py", "tools/*.py", f"{SOURCES.relative_to(ROOT)}/*/test/**/*.py")
    for path in ROOT.glob(pattern)
)
PUBLIC = {"_replace", "_asdict", "_fields", "_make", "_repr_html_"}
"""Public names with an underscore: those of named tuples, and the one that notebooks ask for."""
OWN = {"self", "cls"}


def private_accesses(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and name of each private member that is read, patched or imported, but of `self`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and is_private(node.attr):
            if not (isinstance(node.value, ast.Name) and node.value.id in OWN):
                yield node.lineno, node.attr
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.lineno, alias.name) for alias in node.names if is_private(alias.name))
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in PATCHES:
            words = [part for text in strings(node) for part in text.split(".")]
            yield from ((node.lineno, word) for word in words if is_private(word))


PATCHES = {"setattr", "getattr", "delattr"}


def strings(call: ast.Call) -> list[str]:
    """Return the literal texts among the arguments of a call."""
    return [arg.value for arg in call.args if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and name not in PUBLIC


def test_private_accesses_are_found():
    lines = ["a._b", "self._c", "from x import _d", "m.setattr(a, '_e', 1)", "m.setattr('x.y._f', 1)", "p._replace()"]
    source = "\n".join(lines)
    assert sorted(name for _, name in private_accesses(ast.parse(source))) == ["_b", "_d", "_e", "_f"]


def test_no_test_reaches_into_private_members():
    found = [
        f"{path.relative_to(ROOT)}:{line} {name}"
        for path in READERS
        for line, name in private_accesses(ast.parse(Path(path).read_text()))
    ]
    assert not found, "\n".join(found)
