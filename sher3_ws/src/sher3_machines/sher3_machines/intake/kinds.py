"""The kinds of machine this package knows: every folder with a `kind.py`. A new kind is a new folder."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from sher3_common import FileError, read_yaml

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kind import Kind

PACKAGE, INTAKE, DOOR = "sher3_machines", "intake", "kind"
"""This package, its folder that is no kind, and the module by which the other folders give theirs."""


@lru_cache(maxsize=1)
def kinds() -> Mapping[str, Kind[Any, Any]]:
    """Return every kind of machine of this package by its name."""
    return kinds_in(Path(__file__).parents[1])


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
