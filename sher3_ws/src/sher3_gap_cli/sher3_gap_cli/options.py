"""Options that several commands share, and how a command ends when something it was given is wrong."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from sher3_common.commands import options
from sher3_common.commands.completing import CASE, Completer, folders_with, words
from sher3_common.errors import Sher3Error

BAD_INPUT, reported = options.BAD_INPUT, options.reported
RobotFile = Annotated[Path | None, typer.Option(help="robot.yaml of the nominal model; default: the case's.")]
NominalFile = Annotated[Path | None, typer.Option(help="robot.yaml; the nominal robot by default.")]
Library = Annotated[
    list[Path] | None,
    typer.Option("--library", help="File or folder with pages of effects of your own; repeat for more."),
]
Trust = Annotated[
    bool, typer.Option("--trust", help="Run the Python files that --library names: they may do all that you may.")
]
Bet = Annotated[
    bool, typer.Option("--bet", help="Take the best bet of every place, also where the verdict abstains; say its odds.")
]
VerdictFile = Annotated[Path, typer.Argument(help="verdict.json of `sher3 gap diagnose`.")]


def effects(families: bool = False) -> Completer:
    """Return what the tab key offers for an effect."""

    def names() -> set[str]:
        from sher3_effects import every

        known = every()
        return set(known) | ({page.family for page in known.values()} if families else set())

    return words(names)


def case_argument(text: str) -> Any:
    """Return the argument for a case folder, with the text of its help."""
    return typer.Argument(help=text, autocompletion=folders_with(CASE))


class RequestError(Sher3Error):
    """What was asked for makes no sense: no such effect, two cases of one name, a cluster that does not answer."""


def require_sher_case(case: Path, instead: str) -> Path:
    """Return a case of the SHER.

    Args:
        case: folder.
        instead: what to do with a case of another machine.

    Raises:
        RequestError: it is a case of another machine.
    """
    from sher3_machines import is_machine_case

    if is_machine_case(case):
        raise RequestError(f"{case}: is a case of another machine", limit="cases of the SHER", remedy=instead)
    return case


def check_writable(files: Sequence[Path | None] = (), folders: Sequence[Path | None] = ()) -> None:
    """Refuse where nothing could be written, before any work is done for it.

    Args:
        files: to write, into folders that exist.
        folders: to make, or to write into.

    Raises:
        RequestError: a folder is a file or the other way round, is missing, or may not be written.
    """
    for path in filter(None, files):
        _check(path, path.parent, "is a folder" if path.is_dir() else "")
    for path in filter(None, folders):
        _check(path, next(p for p in (path, *path.absolute().parents) if p.exists()), "")


def _check(path: Path, folder: Path, wrong: str) -> None:
    if not folder.exists():
        wrong = f"there is no folder {folder}"
    elif not folder.is_dir():
        wrong = f"{folder} is no folder"
    elif not os.access(path if path.exists() else folder, os.W_OK):
        wrong = "Permission denied"
    if wrong:
        raise RequestError(f"{path}: cannot be written", value=wrong, remedy="choose another --out")


def written(path: Path, text: str) -> None:
    """Write a file that was asked for; raises RequestError where it cannot be written."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise RequestError(f"{path}: cannot be written", value=error.strerror, remedy="choose another --out") from error


def echo_result(as_json: bool, data: Mapping[str, Any], text: str) -> None:
    """Print what was found: as plain data in one JSON object, or in words."""
    typer.echo(json.dumps(data, default=str) if as_json else text)
