"""No rule about one effect stands in this package: pages say everything, and the face of `sher3_effects` gives them."""

import ast
from pathlib import Path

import sher3_static
from sher3_effects import every

FILES = sorted(Path(sher3_static.__file__).parent.rglob("*.py"))


def test_no_file_imports_a_page():
    """Pages lie in the folders of their families; what stands above them is shared."""
    for path in FILES:
        found = [n.module for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.ImportFrom)]
        assert not [m for m in found if m and m.startswith("sher3_effects.") and m.count(".") > 1], path


def test_no_file_names_an_effect():
    known = set(every())
    for path in FILES:
        words = {n.value for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Constant)}
        assert not known & {w for w in words if isinstance(w, str)}, path
