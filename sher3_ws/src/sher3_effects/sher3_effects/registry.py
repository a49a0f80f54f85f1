"""Finds the pages: of this package, and of the files and folders that the user names.

Every class that derives from `Page` and has an id is a page. A file of the user's own needs no registration: its path,
or that of its folder, stands in the environment variable SHER3_LIBRARY (paths parted like those of PATH) or in the
option `--library`, beside `--trust`, since reading Python runs it. A discovered effect is a YAML file, named by itself.
A page of the user's takes the place of one with the same id. Every process that reads the variable knows the same
pages, those that `sher3 up` starts too.
"""

from __future__ import annotations

import importlib
import os
import pkgutil
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import lru_cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from sher3_common import FileError
from sher3_sim.effect import PlantEffect

from sher3_effects.page import Page

VARIABLE = "SHER3_LIBRARY"
"""Environment variable that names files and folders with pages of the user's own."""

DATA = (".yaml", ".yml")
"""Files of discovered effects, which are data; all others are Python, and reading them runs them."""

ONE_ENCODER = frozenset({"alone", "behind"})
"""Facts that an axis has one encoder, at its motor or at its load; pages ask for them that look for what it hides."""


def library() -> Mapping[str, Page]:
    """Return the pages of the robot by effect id, in alphabetical order."""
    return {e.id: e for e in pages("robot")}


def every() -> Mapping[str, Page]:
    """Return a page for each effect of any kind of machine by id, alphabetically; the robot's form if it has one."""
    found: dict[str, Page] = {}
    for page in _pages(os.environ.get(VARIABLE, "")):
        if page.id not in found or "robot" in page.kinds:
            found[page.id] = page
    return {i: found[i] for i in sorted(found)}


def computed(parameter: str) -> Page:
    """Return the page of the effect of which a parameter is read off a record, see `Page.computed`."""
    return next(page for page in every().values() if page.computed == parameter)


def plants() -> Mapping[str, type[PlantEffect]]:
    """Return the effects' forms in the plant by effect id, in alphabetical order."""
    return {e.id: e.plant for e in pages("robot") if e.plant is not None}


def pages(kind: str, facts: Collection[str] | None = None) -> list[Page]:
    """Return the pages written for a kind of machine, in alphabetical order of their ids.

    Args:
        kind: a word of `sher3_diagnosis.effect.KINDS`.
        facts: what is known, see `Effect.needs`; pages that need more are left out. None: everything is known, so that
            no encoder is alone.

    Raises:
        FileError: a file of the user's own cannot be read.
    """
    found = {e.id: e for e in _pages(os.environ.get(VARIABLE, "")) if kind in e.kinds and _has_its_facts(e, facts)}
    return [found[i] for i in sorted(found)]


def _has_its_facts(page: Page, facts: Collection[str] | None) -> bool:
    """Whether all that a page needs is known."""
    return not ONE_ENCODER & set(page.needs) if facts is None else set(page.needs) <= set(facts)


def add_library(paths: Sequence[Path], trust: bool = False) -> None:
    """Name files and folders with pages for this process and those it starts.

    Args:
        paths: of the files and folders.
        trust: Python files among them may be run; they may do all that the user may.

    Raises:
        FileError: a path is not there, a file below it cannot be read as pages, or it is Python that nobody trusts.
    """
    python = [] if trust else [file for path in paths for file in _files(path) if file.suffix not in DATA]
    if python:
        remedy = "read it, then name it in the option --library with --trust, or in SHER3_LIBRARY"
        raise FileError("is Python, which would be run", path=python[0], remedy=remedy)
    known = [x for x in os.environ.get(VARIABLE, "").split(os.pathsep) if x]
    named = os.pathsep.join([*known, *(str(p.resolve()) for p in paths if str(p.resolve()) not in known)])
    _pages(named)
    os.environ[VARIABLE] = named


@lru_cache(maxsize=8)
def _pages(named: str) -> tuple[Page, ...]:
    own = [x for x in pkgutil.walk_packages([str(Path(__file__).parent)], f"{__package__}.") if not x.ispkg]
    found = [page for x in own for page in _defined_in(importlib.import_module(x.name))]
    files = [file for path in named.split(os.pathsep) if path for file in _files(Path(path))]
    return (*found, *(page for file in files for page in _pages_of(file)))


def _files(path: Path) -> Iterator[Path]:
    if not path.exists():
        raise FileError("is not there", path=path, remedy="name a file or folder with pages of effects")
    yield from sorted(path.rglob("*.py")) if path.is_dir() else [path]


def _pages_of(file: Path) -> list[Page]:
    """Return the pages of a file of the user's: of Python, or one that was discovered."""
    if file.suffix in DATA:
        from sher3_effects.found_page import read_found

        return [read_found(file)]
    return _defined_in(_loaded(file))


def _loaded(file: Path) -> ModuleType:
    """Import a file of the user's under a name that no other file has."""
    name = f"sher3_library.{file.stem}_{abs(hash(str(file.resolve()))):x}"
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, file)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever a file of somebody else's raises when it is run
        del sys.modules[name]
        remedy = "correct the file, or do not name it"
        raise FileError("is not a page of an effect", path=file, value=f"{error}", remedy=remedy) from error
    return module


def _defined_in(module: ModuleType) -> list[Page]:
    """Return an instance of every page that a module defines itself."""
    return [
        thing()
        for thing in vars(module).values()
        if isinstance(thing, type)
        and issubclass(thing, Page)
        and thing.__module__ == module.__name__
        and hasattr(thing, "id")
    ]
