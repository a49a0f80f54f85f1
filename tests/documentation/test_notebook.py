"""The notebook runs from its first cell to its last, in a folder of its own, and finds the fault it was not told."""

import json
import os
import subprocess
import sys

import pytest
from sources import ROOT

NOTEBOOK = ROOT / "docs" / "tutorial" / "bag-to-verdict.ipynb"


@pytest.mark.slow
def test_the_notebook_runs(tmp_path):
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert len(code) == 4
    (tmp_path / "cells.py").write_text("\n\n".join(code))
    environment = {**os.environ, "MPLBACKEND": "agg"}
    done = subprocess.run(
        [sys.executable, "cells.py"], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "attributed" in done.stdout and "backlash on tilt" in done.stdout
    assert (tmp_path / "difference.png").stat().st_size > 5000


def test_it_is_stored_without_outputs():
    """Outputs would be figures of some other day."""
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    assert all(not cell.get("outputs") for cell in cells)
