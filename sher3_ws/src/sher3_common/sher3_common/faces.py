"""The face of a package: names that are imported only when they are used (PEP 562).

A face names what a package offers, and importing one small name must not load the whole package. Every `__init__`
that needs this lists its names twice: under `TYPE_CHECKING`, where type checkers and editors read them, and in the
table of `lazy`, which finds them at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any


def lazy(package: str, homes: Mapping[str, Sequence[str]]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return the `__getattr__` and the `__dir__` of a package.

    Args:
        package: the `__name__` of the package.
        homes: names by the module they are defined in; the modules are given relative to the package.

    The returned `__getattr__` raises AttributeError for a name that is not in the table.
    """
    home = {name: module for module, names in homes.items() for name in names}

    def face_getattr(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name)
        return getattr(import_module(f"{package}.{home[name]}"), name)

    def face_dir() -> list[str]:
        return sorted(home)

    return face_getattr, face_dir
