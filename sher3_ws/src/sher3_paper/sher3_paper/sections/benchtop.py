"""The bench-top evaluation: the paper's tables, beside the results of `sher3 benchtop` when they are given."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sher3_common import FileError, read_text

from sher3_paper.comparison import Comparison, Section, Table
from sher3_paper.tables import printed

COMMAND = "sher3 benchtop"
MAX_BYTES = 1 << 22


def benchtop(results: Path | None = None) -> Section:
    """Return the part on the bench-top tests.

    Args:
        results: JSON object that maps quantities, named as here, to values in the units shown here.

    Raises:
        FileError: the file is missing, too large or not such JSON.
    """
    measured = _read(results) if results is not None else {}
    lines = [_line(name, unit, value, measured) for name, unit, value in quantities()]
    text = (
        "Accuracy, repeatability, resolution and compliance as measured on the running graph with the two-camera "
        "model, whose RMS error is made anew at every reading. Values appear once a bench-top evaluation has been run "
        "and its results are passed with `--benchtop`. The table beside them reads the same motions with the RMS error "
        "as a smooth distortion of the view, and without cameras."
    )
    return Section("benchtop", "Bench-top evaluation", text, lines, _readings(measured))


def quantities() -> list[tuple[str, str, float]]:
    """Return name, unit and printed value of every bench-top figure of the paper."""
    tables = printed()
    found: list[tuple[str, str, float]] = []
    for motion in ("x_motion", "y_motion", "z_motion"):
        for error, (mean, spread) in tables["accuracy_table"][motion].items():
            found.append((f"accuracy/{motion}/{error}/mean", "um", mean))
            found.append((f"accuracy/{motion}/{error}/std", "um", spread))
    for test in ("grid_2mm", "grid_10um"):
        found += [(f"repeatability/{test}/{axis}", "um", v) for axis, v in tables["repeatability"][test].items()]
    table = tables["deflection_table"]
    for axis in "xyz":
        for position, value in zip(table["positions"], table[axis], strict=True):
            found.append((f"compliance/{axis}/({position[0]}, {position[1]})", "um/N", value))
    return [(name, unit, float(value)) for name, unit, value in found]


def _line(name: str, unit: str, value: float, measured: dict[str, Any]) -> Comparison:
    if name not in measured:
        return Comparison(name, unit, value, None, "not run", COMMAND)
    return Comparison(name, unit, value, float(measured[name]), "computed", COMMAND, "simulated robot")


def _readings(measured: dict[str, Any]) -> list[Table]:
    """Return the table of every figure, printed or not, by what the error of the cameras is taken for."""
    names = [name for name in measured if f"tip/{name}" in measured]
    if not names:
        return []
    rows = [[name, *(f"{measured[kind + name]:.3g}" for kind in ("", "field/", "tip/"))] for name in names]
    columns = ["quantity [um, um/N]", "camera, noise", "camera, distortion", "no camera"]
    return [Table("What the cameras make of the same motions", columns, rows)]


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(read_text(path, MAX_BYTES))
        values = {name: float(value) for name, value in data.items()}
    except (ValueError, AttributeError, TypeError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(
            "holds no bench-top results", path=path, remedy="write it with sher3 benchtop --json"
        ) from error
    return values
