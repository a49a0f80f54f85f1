"""Excitations as files, for the player on the graph and for the simulator alike.

Format `sher3.excitation/1`: a YAML header, and beside it an npz with `position` and `velocity`, (n, 5) each, one row
per control period, actuators in the fixed order, SI units. Keys of the header: `schema`, `name`, `amplitude`,
`posture`, `period` [s], `loads` (rows from [s], to [s], Fx, Fy, Fz [N in {b}]), `data` (the npz by its plain name), and
`about`, free text for people.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_common import FileError, dump_yaml, read_yaml
from sher3_common.files.arrays import read_arrays
from sher3_description import Robot

from sher3_gap.excitation import Excitation, check_limits

SCHEMA = "sher3.excitation/1"
MAX_TICKS = 600_000
MAX_BYTES = 2 * MAX_TICKS * 5 * 8 + 4096


class _Header(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    schema_: Literal["sher3.excitation/1"] = Field(alias="schema")
    name: str = Field(min_length=1, max_length=64, pattern=r"^[a-z][a-z0-9_]*$")
    amplitude: float = Field(gt=0.0, le=10.0)
    posture: str = ""
    period: float = Field(gt=0.0, le=0.1)
    loads: list[tuple[float, float, float, float, float]] = []
    data: str
    about: dict[str, Any] = {}


def save_excitation(path: Path, excitation: Excitation, about: Mapping[str, Any] | None = None) -> Path:
    """Write header and samples; return the header's path.

    Raises:
        FileError: the files cannot be written.
    """
    data = path.with_suffix(".npz")
    header = {
        "schema": SCHEMA,
        "name": excitation.name,
        "amplitude": excitation.amplitude,
        "posture": excitation.posture,
        "period": excitation.period,
        "loads": [list(row) for row in excitation.loads],
        "data": data.name,
        "about": dict(about or {}),
    }
    try:
        path.write_text(dump_yaml(header), encoding="utf-8")
        np.savez_compressed(data, position=excitation.position, velocity=excitation.velocity)
    except OSError as error:
        raise FileError("cannot be written", path=path, value=error.strerror, remedy="choose another name") from error
    return path


def load_excitation(path: Path, robot: Robot) -> Excitation:
    """Read an excitation and check it against the robot's limits.

    Raises:
        FileError: a file is missing, too large, not of the schema, or of another control period.
        ExcitationError: a limit of the robot is not kept.
    """
    header = _read_header(path)
    if abs(header.period / robot.control_period - 1.0) > 1e-6:
        remedy = "design it again for this robot"
        raise FileError("control period", path=path, value=header.period, limit=robot.control_period, remedy=remedy)
    position, velocity = _read_samples(path.parent / header.data)
    made = Excitation(
        header.name, header.amplitude, header.posture, robot.control_period, position, velocity, tuple(header.loads)
    )
    return check_limits(made, robot)


def about_excitation(path: Path) -> dict[str, Any]:
    """Return what an excitation file says of itself; raises FileError."""
    return _read_header(path).about


def _read_header(path: Path) -> _Header:
    try:
        header = _Header.model_validate(read_yaml(path))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(x) for x in first["loc"]) or "the file"
        raise FileError(
            f"is not an excitation: {where}: {first['msg']}",
            path=path,
            limit=SCHEMA,
            remedy="name a file of `sher3 gap experiment`",
        ) from error
    if PurePosixPath(header.data).name != header.data or header.data in ("", "..") or "\0" in header.data:
        remedy = "name a file in the same folder"
        raise FileError("data must be named by its plain name", path=path, value=repr(header.data), remedy=remedy)
    return header


def _read_samples(path: Path) -> tuple[np.ndarray, np.ndarray]:
    stored = read_arrays(path, ("position", "velocity"), MAX_BYTES)
    try:
        position, velocity = (np.asarray(stored[key], dtype=float) for key in ("position", "velocity"))
    except ValueError as error:
        raise FileError(f"samples are no numbers: {error}", path=path, remedy="design it again") from error
    if position.ndim != 2 or position.shape[1] != 5 or velocity.shape != position.shape:
        raise FileError(
            "samples have the wrong shape",
            path=path,
            value=(position.shape, velocity.shape),
            limit="(n, 5)",
            remedy="design it again",
        )
    if not 2 <= len(position) <= MAX_TICKS:
        raise FileError(
            "number of samples", path=path, value=len(position), limit=f"2 to {MAX_TICKS}", remedy="design it again"
        )
    if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
        raise FileError("a sample is not finite", path=path, remedy="design it again")
    return position, velocity
