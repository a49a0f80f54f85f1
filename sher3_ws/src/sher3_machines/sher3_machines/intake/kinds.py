"""The kinds of machine: what the entry points of this project's packages, and of anybody's, name.

A package gives a kind by an entry point of the group `sher3.kinds` that names its `Kind`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from sher3_common import FileError, read_yaml

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kind import Kind

GROUP = "sher3.kinds"
"""Group of entry points by which packages give kinds."""
DRAFT_IT = "add it: `sher3 gap describe DATA` drafts a description that has it; see docs/reference/real-data.md"
"""What to do where a field is missing that has no usual value."""


@lru_cache(maxsize=1)
def kinds() -> Mapping[str, Kind[Any, Any]]:
    """Return every kind of machine by its name.

    Raises:
        MachineError: an entry point cannot be loaded, is no kind, or has the name of another one.
    """
    return found_kinds()


def found_kinds() -> Mapping[str, Kind[Any, Any]]:
    """Return the kinds that installed packages give, in the order of their names; raises MachineError as `kinds`.

    A package that is installed twice, by pip and in a workspace, gives its kinds once.
    """
    points = {point.value: point for point in entry_points(group=GROUP)}
    found: dict[str, Kind[Any, Any]] = {}
    for point in sorted(points.values(), key=lambda point: point.name):
        try:
            kind = point.load()
        except Exception as error:  # whatever a package of somebody else's raises when it is imported
            remedy = "correct or remove the package"
            raise MachineError(f"kind {point.value}: cannot be loaded", value=str(error), remedy=remedy) from error
        if not isinstance(kind, Kind):
            remedy = "name an instance of a class that derives from sher3_machines.intake.kind.Kind"
            raise MachineError(f"kind {point.value}: is no kind", value=type(kind).__name__, remedy=remedy)
        if kind.name in found:
            remedy = "give it another name"
            raise MachineError(f"kind {point.value}: its name is taken", value=kind.name, remedy=remedy)
        found[kind.name] = kind
    return found


def load_description(path: Path) -> Description:
    """Read a description of a machine, YAML.

    Raises:
        MachineError: the file cannot be read, its kind is not known, or a field is wrong; the error names the field.
    """
    try:
        data = read_yaml(path)
    except FileError as error:
        raise MachineError(error.what, value=error.value, limit=error.limit, remedy=error.remedy) from error
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
        missing = first["type"] == "missing"
        raise MachineError(
            f"{path}: {place}: {first['msg']}",
            value="it is not there" if missing else repr(first["input"])[:80],
            remedy=DRAFT_IT if missing else "see docs/reference/real-data.md",
        ) from error
