"""The sources of the project as the tests read them."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "sher3_ws" / "src"
FILES = sorted([*SOURCES.glob("*/sher3_*/**/*.py"), *SOURCES.glob("*/sher3/**/*.py")])
FILE_OF = {
    ".".join(path.relative_to(SOURCES).with_suffix("").parts[1:]).removesuffix(".__init__"): path for path in FILES
}
"""Dotted name of a module -> its file."""
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/package.xml"))


@cache
def imports(path: Path) -> frozenset[str]:
    """Return the top-level names of every absolute import of a file, also of those inside functions.

    What only the type checker sees does not count, nor do the samples, which are plain tuples.
    """
    return frozenset(module.split(".")[0] for module in modules(path))


def modules(path: Path, types: bool = False) -> set[str]:
    """Return the same as dotted names; of `from a.b import c` both `a.b` and `a.b.c`, which may be a module too.

    With `types`, also what only the type checker sees.
    """
    return _modules(path)[types]


@cache
def _modules(path: Path) -> tuple[set[str], set[str]]:
    tree = ast.parse(path.read_text())
    return _imported(_walk(tree)), _imported(ast.walk(tree))


def _imported(nodes: Iterable[ast.AST]) -> set[str]:
    names: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            samples = all(alias.name.endswith("Sample") for alias in node.names)
            if samples and node.module in ("sher3_runtime", "sher3_common.samples"):
                continue
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def reached(path: Path) -> set[str]:
    """Return the dotted names a file imports, itself or through files of the project that it imports."""
    seen: set[str] = set()
    left = [path]
    while left:
        new = modules(left.pop()) - seen
        seen |= new
        left += [FILE_OF[name] for name in new if name in FILE_OF]
    return seen


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    yield node
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING":
            continue
        yield from _walk(child)


@cache
def package_of(path: Path) -> str:
    """Return the package a source file belongs to."""
    return path.relative_to(SOURCES).parts[0]
