"""The kinds of machine: of this package every folder with a `kind.py`, of any other what its entry points name.

A package of anybody's adds a kind by an entry point of the group `sher3.kinds` that names its `Kind`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from sher3_common import FileError, read_yaml

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kind import Kind

PACKAGE, INTAKE, DOOR = "sher3_machines", "intake", "kind"
"""This package, its folder that is no kind, and the module by which the other folders give theirs."""


GROUP = "sher3.kinds"
"""Group of entry points by which other packages give kinds of their own."""


@lru_cache(maxsize=1)
def kinds() -> Mapping[str, Kind[Any, Any]]:
    """Return every kind of machine by its name, those of other packages too.

    Raises:
        MachineError: an entry point cannot be loaded, is no kind, or has the name of another one.
    """
    return {**kinds_in(Path(__file__).parents[1]), **kinds_of_others()}


def kinds_of_others() -> Mapping[str, Kind[Any, Any]]:
    """Return the kinds that other packages give; raises MachineError as `kinds` does."""
    own = kinds_in(Path(__file__).parents[1])
    found: dict[str, Kind[Any, Any]] = {}
    for point in entry_points(group=GROUP):
        try:
            kind = point.load()
        except Exception as error:  # whatever a package of somebody else's raises when it is imported
            remedy = "correct or remove the package"
            raise MachineError(f"kind {point.value}: cannot be loaded", value=str(error), remedy=remedy) from error
        if not isinstance(kind, Kind):
            remedy = "name an instance of a class that derives from sher3_machines.intake.kind.Kind"
            raise MachineError(f"kind {point.value}: is no kind", value=type(kind).__name__, remedy=remedy)
        if kind.name in own or kind.name in found:
            remedy = "give it another name"
            raise MachineError(f"kind {point.value}: its name is taken", value=kind.name, remedy=remedy)
        found[kind.name] = kind
    return found


def kinds_in(package: Path) -> Mapping[str, Kind[Any, Any]]:
    """Return the kinds whose folders lie in one of the folders of this package, by their names."""
    folders = sorted(path.parent.name for path in package.glob(f"*/{DOOR}.py") if path.parent.name != INTAKE)
    found = [import_module(f"{PACKAGE}.{folder}.{DOOR}").KIND for folder in folders]
    return {kind.name: kind for kind in found}


def load_description(path: Path) -> Description:
    """Read a description of a machine, YAML.

    Raises:
        MachineError: the file cannot be read, its kind is not known, or a field is wrong; the error names the field.
    """
    try:
        data = read_yaml(path)
    except FileError as error:
        raise MachineError(f"{path}: cannot be read", value=str(error), remedy="give a YAML description") from error
    name = data.get("kind")
    kind = kinds().get(name) if isinstance(name, str) else None
    if kind is None:
        raise MachineError(
            f"{path}: kind: no such kind of machine",
            value=repr(name)[:80],
            limit=", ".join(kinds()),
            remedy="see docs/reference/real-data.md",
        )
    try:
        return kind.description.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise MachineError(
            f"{path}: {place}: {first['msg']}",
            value=repr(first["input"])[:80],
            remedy="see docs/reference/real-data.md",
        ) from error
