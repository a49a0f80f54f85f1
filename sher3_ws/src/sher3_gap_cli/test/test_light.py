"""Help is quick: nothing heavy is imported before a command runs."""

import subprocess
import sys

HEAVY = ("numpy", "scipy", "numba", "matplotlib", "jinja2", "pydantic", "joblib", "sher3_diagnosis")


def loaded(statement):
    """Return which of the heavy modules a statement loads in a fresh interpreter."""
    code = f"import sys; {statement}; print(*(m for m in {HEAVY!r} if m in sys.modules))"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


def test_the_commands_import_nothing_heavy():
    assert loaded("import sher3_gap_cli.app") == []


def test_the_face_of_the_engine_draws_nothing():
    found = loaded("from sher3_diagnosis import Channel, Machine")
    assert "matplotlib" not in found and "jinja2" not in found
