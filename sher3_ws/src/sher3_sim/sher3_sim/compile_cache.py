"""Where the plant's compiled code is kept on disk: one folder per state of its sources.

Numba's cache notices a change of the file a function stands in, not of the files it inlines; see
`sher3_kinematics.compile_cache`, inside whose folder this one lies.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numba
import sher3_kinematics.kernel  # noqa: F401  (selects the outer folder)


def select_cache_folder() -> Path | None:
    """Point numba's cache to a folder named by these sources; a `NUMBA_CACHE_DIR` of the user stays in force."""
    outer = str(getattr(numba.config, "CACHE_DIR", ""))
    if os.environ.get("NUMBA_CACHE_DIR") or not outer:
        return None
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    folder = Path(outer).with_name(f"{Path(outer).name}-sim-{digest.hexdigest()[:16]}")
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    return folder


select_cache_folder()
