"""The notebook runs from its first cell to its last, in a folder of its own, and finds the fault it was not told."""

import json
import os
import subprocess
import sys

import pytest
from sources import ROOT

NOTEBOOK = ROOT / "docs" / "tutorial" / "bag-to-verdict.ipynb"
ONE_CALL = ROOT / "docs" / "tutorial" / "gap-in-one-call.ipynb"


def code_of(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def run(python, code, folder):
    """Return what the cells print, run one after the other."""
    (folder / "cells.py").write_text("\n\n".join(code))
    environment = {**os.environ, "MPLBACKEND": "agg"}
    done = subprocess.run(
        [python, "cells.py"], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


@pytest.mark.slow
def test_the_notebook_runs(tmp_path):
    code = code_of(NOTEBOOK)
    assert len(code) == 4
    said = run(sys.executable, code, tmp_path)
    assert "attributed" in said and "backlash on tilt" in said
    assert (tmp_path / "difference.png").stat().st_size > 5000


def test_the_notebook_of_one_call_runs(tmp_path, forked_python):
    """And writes nothing but the picture that it is told to."""
    said = run(forked_python.folder / "python", code_of(ONE_CALL), tmp_path)
    assert "attributed: Coulomb friction on elbow" in said
    assert {path.name for path in tmp_path.iterdir()} == {"cells.py", "gap.png"}


@pytest.mark.parametrize("notebook", [NOTEBOOK, ONE_CALL], ids=lambda path: path.stem)
def test_it_is_stored_without_outputs(notebook):
    """Outputs would be figures of some other day."""
    cells = json.loads(notebook.read_text())["cells"]
    assert all(not cell.get("outputs") for cell in cells)
