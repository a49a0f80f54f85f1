"""The decorator of the compiled parts: numba, kept on disk in a folder named by the sources of this package.

Numba's cache notices a change of the file a function stands in, not of the files it inlines; a folder per state of
the sources cannot be stale. It lies beside the one of `sher3_kinematics.compile_cache`, whose name holds the state of
the kernels.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import sher3_description.reasons
import sher3_kinematics.kernel  # noqa: F401  (selects the folder of the kernels)

F = TypeVar("F", bound=Callable[..., Any])


def _folder() -> str:
    outer = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    if os.environ.get("NUMBA_CACHE_DIR") or not outer:
        return str(outer)
    digest = hashlib.sha256()
    reasons = Path(sher3_description.reasons.__file__)
    for path in [reasons, *sorted(Path(__file__).parent.glob("*.py"))]:
        source = path.read_bytes()
        if b".compiled import" in source or path == reasons:
            digest.update(path.name.encode() + b"\0" + source)
    return str(Path(outer).with_name(f"{Path(outer).name}-control-{digest.hexdigest()[:16]}"))


_FOLDER = _folder()


def compiled(function: F) -> F:
    """Compile a function; its cache folder is chosen here and nowhere else, so other packages keep theirs."""
    outer = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    numba.config.CACHE_DIR = _FOLDER  # type: ignore[attr-defined]
    try:
        return cast(F, numba.njit(cache=True)(function))
    finally:
        numba.config.CACHE_DIR = outer  # type: ignore[attr-defined]
