"""What is known of one effect stands on its page: other modules ask the page, and know neither its class nor its id."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import sher3_effects
from sher3_effects.page import CONSTANTS
from sher3_effects.registry import every
from sources import FILES, SOURCES, package_of

PAGES = Path(sher3_effects.__file__).parent
GAP = {f"sher3_{room}" for room in ("diagnosis", "machines", "chain", "static", "gap", "gap_cli", "export", "public")}
"""Packages that find and pass on effects; those that hold truths and scores of answers say which effect there is."""

WORDS = {"sher3_export/targets/isaac.py": 1}
"""Modules in which the id of an effect stands, and how often: it names a field of Isaac Lab, `viscous_friction`."""


def named(path: Path) -> str:
    return path.relative_to(SOURCES / package_of(path)).as_posix()


def is_page(module: str) -> bool:
    """Whether a module holds pages: those in a folder of a family do; views and operators beside them do not."""
    parts = module.split(".")
    return parts[0] == "sher3_effects" and len(parts) == 3 and (PAGES / parts[1]).is_dir()


def imports_of_pages(tree: ast.AST) -> int:
    """Count imported page modules; the forms of an effect in the plant are what the simulator is made of."""
    found = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.module and is_page(n.module)]
    return sum(any(not name.name.endswith("InPlant") for name in node.names) for node in found)


def words_of(tree: ast.AST) -> Iterator[str]:
    return (n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str))


def words_that_are_ids(tree: ast.AST, ids: set[str]) -> int:
    return sum(word in ids for word in words_of(tree))


def counted(count) -> dict[str, int]:
    found = {named(path): count(ast.parse(path.read_text())) for path in FILES if package_of(path) in GAP}
    return {path: n for path, n in found.items() if n}


def test_no_module_outside_imports_a_page():
    assert not counted(imports_of_pages), "move the fact onto the page and ask the page"


def test_no_module_outside_names_an_effect():
    """Some ids are names of constants of the equation of motion too, which everybody may use."""
    ids = set(every()) - set(CONSTANTS)
    found = counted(lambda tree: words_that_are_ids(tree, ids))
    assert found == WORDS, "give the page a property and ask it; lower what is less now"


def test_both_are_seen():
    text = "from sher3_effects.friction.dry import DryFriction\nfrom sher3_effects.view import AxisView\n"
    assert imports_of_pages(ast.parse(text)) == 1
    assert words_that_are_ids(ast.parse("a = cause.effect == 'play'\nb = ('ripple', 'play of gears')\n"), {"play"}) == 1
