"""The thresholds of the diagnosis as a page: name, value, and the words that stand below each in the sources."""

from __future__ import annotations

import ast
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

from generators.table import table

MODULES = {
    "The engine": "sher3_diagnosis.thresholds",
    "Other machines": "sher3_machines.thresholds",
    "Chains of joints": "sher3_chain.thresholds",
    "Tables of readings": "sher3_static.thresholds",
}
INTRODUCTION = """# Thresholds of the diagnosis

Every number that decides: what it means, the data it was set on, and the command that measures it again. They stand in
one module each; nothing else in the diagnosis compares with a number of its own.

"""


def page() -> str:
    """Return the page."""
    return INTRODUCTION + "\n".join(_section(title, module) for title, module in MODULES.items())


def _section(title: str, module: str) -> str:
    found = find_spec(module)
    if found is None or found.origin is None:
        raise LookupError(f"no module {module}; mend docs/generators/thresholds.py")
    body = ast.parse(Path(found.origin).read_text()).body
    rows = []
    for statement, following in pairwise(body):
        if isinstance(statement, ast.Assign) and isinstance(following, ast.Expr):
            names = ", ".join(f"`{ast.unparse(target)}`" for target in statement.targets)
            rows.append((names, f"`{ast.unparse(statement.value)}`", ast.literal_eval(following.value)))
    return f"## {title}: `{module}`\n\n" + table(("name", "value", "meaning, data, measurement"), rows)
