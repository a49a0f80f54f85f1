"""Pages of the Python reference: one a folder of sources, each module a section filled from its docstrings."""

from __future__ import annotations

import ast
import functools
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INDEX = """Python reference
================

From the docstrings, one page a folder. A package's first page tells what its room is for;
:doc:`the architecture </reference/architecture>` tells who may import whom.

"""
ORPHAN = ":orphan:\n\n"
"""Of a page that is in no menu: a hundred of them in the menu of each page would be a fifth of the build."""


def pages() -> dict[str, str]:
    """Return the text of every page by its file name, the index among them."""
    folders = _all_folders()
    texts = {f"{name}.rst": _page(name, modules) for name, modules in folders.items()}
    return {"index.rst": INDEX + "".join(f"* :doc:`{name}`\n" for name in sorted(folders))} | texts


def module_names() -> list[str]:
    """Return the dotted names of all modules that the pages describe."""
    return [module for name, modules in _all_folders().items() for module in (name, *modules)]


@functools.cache
def _all_folders() -> dict[str, list[str]]:
    return {name: modules for package in _packages() for name, modules in _folders(package).items()}


def _packages() -> list[Path]:
    return sorted(path for path in (ROOT / "sher3_ws" / "src").glob("sher3_*/sher3_*") if path.is_dir())


def _folders(package: Path) -> dict[str, list[str]]:
    """Return the modules of each folder of a package, by dotted name."""
    folders: dict[str, list[str]] = {}
    for init in sorted(package.rglob("__init__.py")):
        dotted = ".".join(init.parent.relative_to(package.parent).parts)
        names = sorted(path.stem for path in init.parent.glob("*.py") if not path.stem.startswith("_"))
        faces = _faces(init)
        modules = sorted((f"{dotted}.{name}" for name in names), key=lambda module: (module not in faces, module))
        folders[dotted] = modules
    return folders


def _faces(init: Path) -> set[str]:
    """Return the modules whose names a folder's face exports, but for errors: what is called stands first."""
    imports = (node for node in ast.walk(ast.parse(init.read_text())) if isinstance(node, ast.ImportFrom))
    return {node.module for node in imports if node.module and not node.module.endswith(".errors")}


def _page(name: str, modules: list[str]) -> str:
    # The face of a folder re-exports; its members stand where they are defined.
    text = f"{ORPHAN}{name}\n{'=' * len(name)}\n\n.. automodule:: {name}\n   :no-members:\n\n"
    for module in modules:
        title = module.removeprefix(f"{name}.")
        text += f"{title}\n{'-' * len(title)}\n\n.. automodule:: {module}\n\n"
    return text
