"""Compiled code goes through one decorator, and no setting of numba is written."""

import re

from sources import FILES, ROOT

DOORS = {"sher3_common/compiled.py", "sher3_common/compiling/named_cache.py"}
WRITES = re.compile(r"config\.\w+ *=[^=]|setattr\([^)]*config|os\.environ\[.NUMBA")
DECORATES = re.compile(r"\bnjit\b|\bnumba\.jit\b|\bcfunc\b|\bvectorize\b")


def short(path) -> str:
    return "/".join(path.relative_to(ROOT / "sher3_ws" / "src").parts[1:])


def test_nobody_writes_a_setting_of_numba():
    found = {short(path) for path in FILES if "numba" in (text := path.read_text()) and WRITES.search(text)}
    assert not found


def test_everything_is_compiled_through_the_decorator():
    found = {short(path) for path in FILES if DECORATES.search(path.read_text())} - DOORS
    assert not found
