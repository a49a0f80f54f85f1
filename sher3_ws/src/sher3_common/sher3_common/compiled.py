"""The one decorator of compiled code: numba, with a cache on disk that cannot be stale.

Numba's own cache notices a change of the file a function stands in. It does not notice a change of the files whose
functions and constants are compiled into that function. Here the compiled code of a module lies in a folder that is
named by all sources the module imports, directly or through others, so an edit anywhere below it selects a new folder.
No setting of numba is written: the folder is chosen for each function alone, whatever was imported before it.
"""

from __future__ import annotations

import contextlib
import functools
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast, overload

from sher3_common.compiling.source_closure import closure_digest

F = TypeVar("F", bound=Callable[..., Any])

KEEP_SECONDS = 7 * 24 * 3600
"""A folder that no process has used for this long is removed: a week of work on other sources does not lose it."""


class Compiler(Protocol):
    """`compiled` with flags of its own: a decorator, and what makes one of further flags."""

    @overload
    def __call__(self, function: F, /) -> F: ...

    @overload
    def __call__(self, **flags: Any) -> Callable[[F], F]: ...


@overload
def compiled(function: F, /) -> F: ...


@overload
def compiled(**flags: Any) -> Callable[[F], F]: ...


def compiled(function: Any = None, /, **flags: Any) -> Any:
    """Compile a function at its first call and keep the machine code on disk.

    Used as `@compiled` or as `@compiled(inline="always")`. Where no folder can be written (a read-only home) the
    function compiles anew in each process. With numba switched off (`NUMBA_DISABLE_JIT`) it stays plain Python.

    Args:
        function: What to compile.
        flags: Options of `numba.njit` other than `cache`.

    Returns:
        Numba's dispatcher, called like the function; a decorator if no function is given.
    """
    if function is None:
        return functools.partial(compiled, **flags)
    import numba  # takes a third of a second: only who compiles something pays it

    dispatcher = numba.njit(**flags)(function)
    folder = cache_folder(function.__module__, Path(function.__code__.co_filename))
    if folder is not None and dispatcher is not function:
        from sher3_common.compiling.named_cache import SourceNamedCache

        dispatcher._cache = SourceNamedCache(function, folder)  # what numba's own enable_caching() sets
    return dispatcher


compiled_ieee = cast(Compiler, functools.partial(compiled, error_model="numpy", nogil=True))
"""`compiled` for mathematics: a division by zero gives infinity or NaN, and other threads run meanwhile."""


def direct(function: Any, *example: Any) -> Callable[..., Any]:
    """Return the machine code of a compiled function for arguments of the types of `example`, called by position.

    A call of a compiled function first finds out the type of every argument, down to the last member of nested tuples.
    That takes 11 us of the 15 us of one tick of the admittance law. Where the types never change, once is enough.
    The caller vouches for the types: dtype and shape of arrays and length of tuples must be those of the example.

    Returns:
        The machine code; the function itself when it is not compiled, as with numba switched off.

    Raises:
        ValueError, TypeError: In a call, for a tuple of another length or a value that is not a number.
    """
    if not hasattr(function, "overloads"):
        return function
    import numba

    types = tuple(numba.typeof(value) for value in example)
    function.compile(types)
    return function.overloads[types].entry_point


def cache_root() -> Path:
    """Return the folder of all compiled code: the user's `NUMBA_CACHE_DIR`, or one below the user's cache folder.

    Raises:
        RuntimeError: The user has no home folder.
    """
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sher3" / "numba"


@functools.cache
def cache_folder(module: str, path: Path) -> Path | None:
    """Make and return the folder of a module's compiled code; None where none can be written.

    Args:
        module: Dotted name of the module, the first part of the folder's name.
        path: Its source.
    """
    try:
        root = cache_root()
        folder = root / f"{module}-{closure_digest(path, module)}"
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            return None
        os.utime(folder)
        _remove_old(root)
    except (OSError, RuntimeError):
        return None
    return folder


@functools.cache
def _remove_old(root: Path) -> None:
    """Remove what no process has used for a while, once in a process; a folder of the user's own is left alone."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return
    oldest = time.time() - KEEP_SECONDS
    for folder in root.iterdir():
        with contextlib.suppress(FileNotFoundError):  # another process removes it at this moment
            if folder.stat().st_mtime < oldest:
                shutil.rmtree(folder, ignore_errors=True)
