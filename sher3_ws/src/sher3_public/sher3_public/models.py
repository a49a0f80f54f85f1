"""The model of a robot in whatever form a person has it: a file, its text, or an object of MuJoCo."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sher3_chain.manipulator.bodies import Bodies, bodies_of, bodies_of_mujoco, read_bodies
from sher3_chain.manipulator.mjcf.reading import BINARY, MAX_BYTES
from sher3_common import FileError, read_text

from sher3_public.errors import InputError


@dataclass(frozen=True)
class Source:
    """A robot's model as it was given.

    Attributes:
        name: for reports.
        bodies: what the diagnosis reads.
        text: XML that corrections are written into; None: an `MjModel` or its binary file was given.
        path: of its file, where there is one.
    """

    name: str
    bodies: Bodies
    text: str | None = None
    path: Path | None = None


def source_of(model: object) -> Source:
    """Return the model of a path, an XML text, an `MjModel` or an `MjSpec`.

    Raises:
        InputError: it is none of these, or the file cannot be read.
        MachineError: the model is wrong, or MJCF is given and MuJoCo is not installed.
    """
    if isinstance(model, str) and "<" in model:
        return Source("model", bodies_of(model, "model"), model)
    if isinstance(model, str | os.PathLike):
        return _file_source(Path(model))
    kind = type(model).__name__
    if kind == "MjSpec":
        spec: Any = model
        return Source(spec.modelname or "model", bodies_of_mujoco(spec.compile(), "model"), spec.to_xml())
    if kind == "MjModel":
        return Source("model", bodies_of_mujoco(model, "model"))
    remedy = "give a path or text of URDF or MJCF, an MjModel or an MjSpec"
    raise InputError("the model is of no known kind", value=kind, remedy=remedy)


def _file_source(path: Path) -> Source:
    if path.suffix == BINARY:
        return Source(path.stem, read_bodies(path))
    try:
        text = read_text(path, MAX_BYTES)
    except FileError as error:
        raise InputError(f"{path}: cannot be read", value=error.reason, remedy="give a URDF or MJCF file") from error
    return Source(path.stem, bodies_of(text, str(path), path), text, path)
