"""A machine's case folder: `machine.yaml` (the description) and `runs/NAME.npz`, in SI on a uniform clock."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from sher3_description import FileError, read_json, read_text

from sher3_gap.machines.arm_data import ArmData, arm_data
from sher3_gap.machines.description import ArmMachine, AxesMachine, load_machine
from sher3_gap.machines.errors import MachineError
from sher3_gap.machines.intake import AxesRun, axes_run
from sher3_gap.machines.tables import read_tables

MACHINE, RUNS = "machine.yaml", "runs"


def is_machine_case(path: Path) -> bool:
    """Whether a folder holds a case of another machine."""
    return (Path(path) / MACHINE).is_file()


def import_case(data: Sequence[Path], description: Path, out: Path) -> list[str]:
    """Turn data files (each a run) and a description into a case folder; returns notes on what was done to the data.

    Raises:
        MachineError: description or data are wrong, or `out` holds something else.
    """
    machine = load_machine(description)
    if out.exists() and any(out.iterdir()) and not is_machine_case(out):
        raise MachineError(f"{out}: is not empty and no case", remedy="choose another --out")
    names = _names(data)
    tables = [read_tables(p) for p in data]
    if isinstance(machine, ArmMachine):
        arms = [arm_data(n, t, machine) for n, t in zip(names, tables, strict=True)]
        arrays = {a.name: {"joints": a.joints, "poses": a.poses} for a in arms}
        notes: list[str] = []
    else:
        runs = [axes_run(n, t, machine) for n, t in zip(names, tables, strict=True)]
        arrays = {r.name: _flat(r) for r in runs}
        notes = [n for r in runs for n in r.notes]
    (out / RUNS).mkdir(parents=True, exist_ok=True)
    for stale in (out / RUNS).glob("*.npz"):
        stale.unlink()
    for name, content in arrays.items():
        np.savez_compressed(out / RUNS / f"{name}.npz", **content)  # type: ignore[arg-type]
    (out / MACHINE).write_text(_resolved(description, machine), encoding="utf-8")
    (out / "import.json").write_text(
        json.dumps({"data": [str(p) for p in data], "notes": notes}, indent=1), encoding="utf-8"
    )
    return notes


def load_axes(path: Path) -> tuple[AxesMachine | ArmMachine, list[AxesRun], list[ArmData]]:
    """Read a machine's case. Raises `MachineError`."""
    machine = load_machine(path / MACHINE)
    files = sorted((path / RUNS).glob("*.npz"))
    if not files:
        raise MachineError(f"{path}: no runs", remedy="import the data again")
    notes = _notes(path / "import.json")
    axes, arms = [], []
    for file in files:
        tables = read_tables(file)
        try:
            if isinstance(machine, ArmMachine):
                arms.append(ArmData(file.stem, tables["joints"], tables["poses"]))
            else:
                axes.append(_run(file.stem, tables, notes))
        except KeyError as error:
            raise MachineError(f"{file}: {error} is missing", remedy="import the data again") from error
    return machine, axes, arms


def _run(name: str, tables: dict, notes: list[str]) -> AxesRun:
    signals: dict[str, dict[str, np.ndarray]] = {}
    for key, x in tables.items():
        if key != "period":
            axis, which = key.rsplit("/", 1)
            signals.setdefault(axis, {})[which] = x
    return AxesRun(name, float(tables["period"][0]), signals, [n for n in notes if n.startswith(f"{name}:")])


def _flat(run: AxesRun) -> dict[str, np.ndarray]:
    return {"period": np.array([run.period]), **{f"{a}/{k}": x for a, s in run.signals.items() for k, x in s.items()}}


def _names(data: Sequence[Path]) -> list[str]:
    names = [p.resolve().name if p.is_dir() else p.stem for p in data]
    return names if len(set(names)) == len(names) else [f"{n}_{i}" for i, n in enumerate(names)]


def _notes(path: Path) -> list[str]:
    try:
        return list(map(str, read_json(path)["notes"]))
    except (FileError, KeyError, TypeError):
        return []


def _resolved(description: Path, machine: AxesMachine | ArmMachine) -> str:
    """The description as written; a URDF is named by its absolute path, so that the case can be moved away from it."""
    text = read_text(description)
    if isinstance(machine, ArmMachine) and machine.urdf is not None:
        text = text.replace(str(machine.urdf), str((description.parent / machine.urdf).resolve()))
    return text


def described(path: Path) -> Path:
    """A description's path; a bare name is one of the descriptions that come with the project."""
    known = Path(__file__).parent / "descriptions" / f"{path.name}.yaml"
    return known if path.suffix == "" and not path.exists() and known.is_file() else path
