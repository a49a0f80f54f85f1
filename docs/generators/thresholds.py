"""The thresholds of the diagnosis: name, value, and the words that stand below each in the sources."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

from generators.table import table

ENGINE = "sher3_diagnosis.thresholds"
"""Its numbers are a page for each question of the diagnosis, as its headings name them."""
OTHERS = {
    "machines": ("Other machines", "sher3_machines.thresholds"),
    "chains": ("Chains of joints", "sher3_chain.thresholds"),
    "readings": ("Tables of readings", "sher3_static.thresholds"),
}
HEADING = re.compile(r"^# -- (.+?) -+$", re.M)
INTRODUCTION = """# Thresholds of the diagnosis

Every number that decides: what it means, the data it was set on, and the command that measures it again. They stand in
one module each; nothing else in the diagnosis compares with a number of its own.

"""


def pages() -> tuple[str, dict[str, str]]:
    """Return the index, and the pages by their files' names."""
    _, *sections = HEADING.split(_source(ENGINE))
    titled = {_slug(title): (title, ENGINE, text) for title, text in zip(sections[::2], sections[1::2], strict=True)}
    titled |= {part: (title, module, _source(module)) for part, (title, module) in OTHERS.items()}
    index = [(f"[{title}](thresholds/{part}.md)", f"`{module}`") for part, (title, module, _) in titled.items()]
    parts = {
        part: f"# Thresholds: {title}\n\nIn `{module}`.\n\n" + table(("name", "value", "meaning, data"), _rows(text))
        for part, (title, module, text) in titled.items()
    }
    return INTRODUCTION + table(("question", "module"), index), parts


def _slug(title: str) -> str:
    return title.partition(":")[0].replace(" ", "-")


def _source(module: str) -> str:
    found = find_spec(module)
    if found is None or found.origin is None:
        raise LookupError(f"no module {module}; mend docs/generators/thresholds.py")
    return Path(found.origin).read_text()


def _rows(text: str) -> Iterator[tuple[str, str, str]]:
    for statement, following in pairwise(ast.parse(text).body):
        if isinstance(statement, ast.Assign) and isinstance(following, ast.Expr):
            names = ", ".join(f"`{ast.unparse(target)}`" for target in statement.targets)
            yield names, f"`{ast.unparse(statement.value)}`", ast.literal_eval(following.value)
