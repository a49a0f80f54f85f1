"""Where compiled code is kept on disk: one folder per state of the sources of this package.

Numba's cache notices a change of the file a function stands in, not of the files whose functions and constants it
takes. Code compiled against old ones would then go on running after an edit or an update; a folder named by the sources
cannot. All sources count: `arrays` and `tip_deflection` end up in compiled code of other packages too.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from pathlib import Path

import numba

KEEP_SECONDS = 7 * 24 * 3600
"""Folders of other states of the sources are removed when unused for this long."""


def source_digest(folder: Path) -> str:
    """Return a short digest of all sources in a folder."""
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def select_cache_folder() -> Path | None:
    """Point numba's cache to the folder of these sources; a `NUMBA_CACHE_DIR` of the user stays in force.

    Returns:
        The folder, or None where the user has chosen one or no folder can be written.
    """
    if os.environ.get("NUMBA_CACHE_DIR"):
        return None
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sher3" / "numba"
    folder = base / source_digest(Path(__file__).parent)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
        for other in base.iterdir():
            if time.time() - other.stat().st_mtime > KEEP_SECONDS:
                shutil.rmtree(other, ignore_errors=True)
    except (OSError, RuntimeError):
        return None
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    return folder


select_cache_folder()
