"""Numba's cache of one function, with a folder that the caller names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserWideCacheLocator

from sher3_common.compiling.telling import TELLING
from sher3_common.compiling.turn import Turn


class SourceNamedCache(FunctionCache):
    """The machine code of one function for each combination of argument types, kept in a given folder.

    Numba chooses the folder by asking locator classes in turn, which see the function alone; the class made here for
    each folder is the only one it asks.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        class Locator(UserWideCacheLocator):
            def get_cache_path(self) -> str:
                return str(folder)

            def ensure_cache_path(self) -> None:
                """Do nothing: the folder was made, and tried, when it was chosen."""

        class Implementation(CompileResultCacheImpl):
            _locator_classes = [Locator]  # noqa: RUF012 (numba's name and type)

        self._impl_class = Implementation
        super().__init__(function)
        self._turn = Turn(folder / f"{self._impl.filename_base}.turn")

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the machine code of these types, None where it must be compiled, which is then told.

        What another process compiles at this moment is waited for.
        """
        found = super().load_overload(sig, target_context)
        if found is None:
            self._turn.take()
            found = super().load_overload(sig, target_context)
            if found is None:
                TELLING.begins()
            else:
                self._turn.leave()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the machine code that was compiled."""
        super().save_overload(sig, data)
        self._turn.leave()
        TELLING.ended()
