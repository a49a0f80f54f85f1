"""A virtual environment of its own that sees the libraries of this one."""

from __future__ import annotations

import site
import subprocess
import sys
from pathlib import Path


def fresh_environment(folder: Path) -> Path:
    """Make an environment in a folder that does not exist yet and return its interpreter."""
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    return folder / "bin" / "python"


def see_libraries(python: Path) -> None:
    """Let an environment see our libraries, behind its own.

    They are added as site directories, so that their own path files count: some libraries live below a prefix.
    """
    where = [python, "-c", "import site; print(site.getsitepackages()[0])"]
    packages = Path(subprocess.check_output(where, text=True).strip())
    (packages / "libraries.pth").write_text(f"import site; [site.addsitedir(p) for p in {site.getsitepackages()!r}]\n")
