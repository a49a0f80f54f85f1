"""The digest of a module's sources follows what the module imports, and nothing else."""

import subprocess
import sys
from pathlib import Path

import pytest

NEAR = """
NEAR = 1
if TYPE_CHECKING:
    from sher3_low import types

    X = 1
import sher3_low.late
"""
FILES = {
    "sher3_top/__init__.py": "",
    "sher3_top/law.py": "from sher3_low import (\n    K,  # a gain\n    words,\n)\nfrom .near import NEAR\n",
    "sher3_top/near.py": NEAR,
    "sher3_top/apart.py": "APART = 1\n",
    "sher3_low/__init__.py": "def __getattr__(name):\n    from sher3_low.numbers import K\n    return K\n",
    "sher3_low/numbers.py": "K = 2.0\n",
    "sher3_low/words.py": "import math, sher3_low.deep as deep\n",
    "sher3_low/deep.py": "",
    "sher3_low/types.py": "",
    "sher3_low/late.py": "",
    "sher3_low/apart.py": "",
}
ASK = """
import sys
from pathlib import Path
from sher3_common.compiling.source_closure import closure_digest
sys.path.insert(0, sys.argv[1])
print(closure_digest(Path(sys.argv[1], "sher3_top/law.py"), "sher3_top.law"))
assert not any(name.startswith(("sher3_top", "sher3_low", "numba")) for name in sys.modules)
"""


@pytest.fixture
def digest(tmp_path: Path):
    """Return `digest(path)`: the digest of `sher3_top.law`, asked in a new process, after a line is added to a file."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)

    def ask(changed: str = "") -> str:
        if changed:
            (tmp_path / changed).write_text(FILES[changed] + "# another state\n")
        command = [sys.executable, "-c", ASK, tmp_path]
        found = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
        if changed:
            (tmp_path / changed).write_text(FILES[changed])
        return found

    return ask


def test_sources_that_are_imported_count(digest) -> None:
    """The file itself, a neighbour, a face and the module it hands on, a module from a list, one behind it."""
    before = digest()
    assert len(before) == 16
    for changed in ("top/law", "top/near", "low/__init__", "low/numbers", "low/words", "low/deep", "low/late"):
        assert digest(f"sher3_{changed}.py") != before, changed
    assert digest() == before


def test_other_sources_do_not(digest) -> None:
    before = digest()
    for changed in ("top/apart", "top/__init__", "low/apart", "low/types"):
        assert digest(f"sher3_{changed}.py") == before, changed
