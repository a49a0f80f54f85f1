"""A machine's case folder: `machine.yaml` (the description) and `runs/NAME.npz`, in SI units."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import FileError, read_json, read_text
from sher3_diagnosis.machine import Machine

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kinds import kinds, load_description
from sher3_machines.intake.notes import merged
from sher3_machines.intake.runs import runs_of
from sher3_machines.intake.tables import read_tables

MACHINE, RUNS, IMPORT = "machine.yaml", "runs", "import.json"
"""The description, the folder of runs, and the record of the import."""


def is_machine_case(path: Path) -> bool:
    """Whether a folder holds a case of another machine."""
    return (Path(path) / MACHINE).is_file()


def described(path: Path) -> Path:
    """Return a description's path; a bare name is one of the descriptions that come with the project."""
    known = Path(__file__).parents[1] / "descriptions" / f"{path.name}.yaml"
    return known if path.suffix == "" and not path.is_file() and known.is_file() else path


def import_case(data: Sequence[Path], description: Path, out: Path) -> list[str]:
    """Turn data files, each of them a run, and a description into a case folder.

    Args:
        data: files or folders of files.
        description: YAML file.
        out: folder of the case; runs of an earlier import are replaced.

    Returns:
        Notes on what was done to the data.

    Raises:
        MachineError: description or data are wrong, or `out` holds something else.
    """
    machine = load_description(description)
    if out.exists() and any(out.iterdir()) and not is_machine_case(out):
        raise MachineError(f"{out}: is not empty and no case", remedy="choose another --out")
    kind = kinds()[machine.kind]
    runs = []
    records, few = kind.chosen(runs_of(data), machine)
    notes = [few] if few else []
    for name, table in records.items():
        parts, note = kind.parts(name, table, machine, len(records))
        notes += [note] if note else []
        runs += [kind.read(part, x, machine) for part, x in parts.items()]
    notes += [note for run in runs for note in run.notes]
    (out / RUNS).mkdir(parents=True, exist_ok=True)
    for stale in (out / RUNS).glob("*.npz"):
        stale.unlink()
    for run in runs:
        np.savez_compressed(out / RUNS / f"{run.name}.npz", **kind.pack(run))  # type: ignore[arg-type]
    (out / MACHINE).write_text(_resolved(description, machine, data), encoding="utf-8")
    record = {"data": [str(path) for path in data], "runs": [run.name for run in runs], "notes": notes}
    (out / IMPORT).write_text(json.dumps(record, indent=1), encoding="utf-8")
    return merged(notes, [run.name for run in runs])


def open_case(path: Path) -> tuple[Machine[Any, Any], list[Any]]:
    """Read a case folder: the machine it describes and its runs in the order in which they were given to the import.

    Raises:
        MachineError: the description is wrong, or no run can be read.
    """
    description = load_description(path / MACHINE)
    kind = kinds()[description.kind]
    given = _listed(path / IMPORT, "runs")
    order = {name: place for place, name in enumerate(given)}
    files = sorted((path / RUNS).glob("*.npz"), key=lambda file: (order.get(file.stem, len(order)), file.stem))
    if not files:
        raise MachineError(f"{path}: no runs", remedy="import the data again")
    notes = _listed(path / IMPORT, "notes")
    runs = []
    for file in files:
        own = [note for note in notes if note.startswith(f"{file.stem}:")]
        try:
            runs.append(kind.unpack(file.stem, read_tables(file), own))
        except KeyError as error:
            raise MachineError(f"{file}: {error} is missing", remedy="import the data again") from error
    return kind.machine(description), runs


def _listed(path: Path, key: str) -> list[str]:
    """Return a list of the record of the import; empty where it is missing or not readable: no answer rests on it."""
    try:
        return list(map(str, read_json(path)[key]))
    except (FileError, KeyError, TypeError):
        return []


def _resolved(path: Path, description: Description, data: Sequence[Path]) -> str:
    """The description as written, the files it names by their absolute path: the case may lie anywhere.

    A file is looked for beside the description, then in or beside the data.
    """
    text = read_text(path)
    for name in description.named_files():
        places = [path.parent, *(x if x.is_dir() else x.parent for x in data)]
        found = next((p / name for p in places if (p / name).is_file()), path.parent / name)
        text = text.replace(name, str(found.resolve()))
    return text
