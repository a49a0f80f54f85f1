"""The sources of the project as the tests read them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "sher3_ws" / "src"
FILES = sorted(SOURCES.glob("*/sher3_*/**/*.py"))
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/package.xml"))


def imports(path: Path) -> set[str]:
    """Return the top-level names of every absolute import of a file, also of those inside functions.

    What only the type checker sees does not count, nor do the samples, which are plain tuples.
    """
    names = set()
    for node in _walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            samples = all(alias.name.endswith("Sample") for alias in node.names)
            if samples and node.module in ("sher3_runtime", "sher3_runtime.samples"):
                continue
            names.add(node.module.split(".")[0])
    return names


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    yield node
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING":
            continue
        yield from _walk(child)


def package_of(path: Path) -> str:
    """Return the package a source file belongs to."""
    return path.relative_to(SOURCES).parts[0]
