"""The file of a case, looked for where no bag can be read."""

from __future__ import annotations

from pathlib import Path

from sher3_bags.errors import CaseError

CASE_FILE = "case.yaml"


def case_file(folder: Path) -> Path:
    """Return the file of a case; raises CaseError, with how a case is made of what is there, where there is none."""
    if not folder.exists():
        raise CaseError("no such folder", path=folder, remedy="name a case folder")
    if not folder.is_dir():
        raise CaseError("a file, no case folder", path=folder, remedy=_remedy(folder))
    if not (folder / CASE_FILE).is_file():
        raise CaseError("no case.yaml", path=folder, remedy=_remedy(folder))
    return folder / CASE_FILE


def _remedy(path: Path) -> str:
    """Return how a case is made of what was named in its place: a recording of this robot, a log of any other."""
    if path.suffix == ".mcap" or any(path.glob("*.mcap")):
        return f"this is a recording; `sher3 gap case {path} --out CASE` makes a case of it"
    if path.is_file():
        return f"a log becomes a case by `sher3 gap describe {path}` and `sher3 gap import`"
    return "name a case folder"
