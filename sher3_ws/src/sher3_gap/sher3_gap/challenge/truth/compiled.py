"""Compilation of the truth plant's kernels, cached per state of all of them.

Numba's cache notices a change of the file a function stands in, not of the files it inlines, so the cache lies in a
folder named by all kernel sources.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])

KERNELS = ("axis", "hysteresis", "loop", "mechanism", "parameters", "tip")


def cache_folder() -> Path | None:
    """Return the folder for these sources; None where the user has chosen one or none can be written."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return None
    digest = hashlib.sha256()
    for name in KERNELS:
        digest.update(Path(__file__).with_name(f"{name}.py").read_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sher3" / "numba"
    folder = base / f"truth-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
    except (OSError, RuntimeError):
        return None
    return folder


_FOLDER = cache_folder()


def compiled(function: F) -> F:
    """Compile a kernel on first use, with IEEE division instead of exceptions; cached in the kernels' own folder."""
    return _compiled(function, inner=False)


def compiled_inner(function: F) -> F:
    """Compile a kernel that only other kernels call: without a way in from Python it compiles faster."""
    return _compiled(function, inner=True)


def _compiled(function: F, *, inner: bool) -> F:
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    if _FOLDER is not None:
        numba.config.CACHE_DIR = str(_FOLDER)  # type: ignore[attr-defined]
    try:
        flags: dict[str, Any] = {"no_cpython_wrapper": inner, "no_cfunc_wrapper": True}
        made: Any = numba.njit(cache=True, error_model="numpy", **flags)(function)
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]
    return cast(F, made)
