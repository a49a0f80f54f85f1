"""The library of effects: one small file per effect of the recorded-run contract, §7."""

from __future__ import annotations

import importlib
import pkgutil

from sher3_gap.library.base import LibraryEffect as LibraryEffect
from sher3_gap.library.base import Shape as Shape
from sher3_gap.library.base import Signature as Signature
from sher3_gap.library.base import View as View


def _collect() -> dict[str, LibraryEffect]:
    found: dict[str, LibraryEffect] = {}
    for module in pkgutil.iter_modules(__path__):
        for thing in vars(importlib.import_module(f"{__name__}.{module.name}")).values():
            if isinstance(thing, type) and issubclass(thing, LibraryEffect) and "id" in vars(thing):
                found[thing.id] = thing()
    return dict(sorted(found.items()))


LIBRARY: dict[str, LibraryEffect] = _collect()
"""Effect id -> effect."""
