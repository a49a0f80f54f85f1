"""An MJCF file by MuJoCo's own loader (an extra): defaults, includes and mesh inertias are resolved as MuJoCo does."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from sher3_machines.errors import MachineError

MAX_BYTES = 20_000_000
"""Largest model file that is read."""

BINARY = ".mjb"
"""Ending of a compiled model, as `mj_saveModel` writes it; each version of MuJoCo reads its own."""
MISSING = "Error opening file"
"""What MuJoCo says of a file that is not there."""


def is_mjcf(text: str) -> bool:
    """Return whether the text of a model file is MJCF; a URDF may hold an element `mujoco` too."""
    return "<mujoco" in text and "<robot" not in text


def mujoco(wanted: object = "MJCF") -> ModuleType:
    """Return MuJoCo; raises MachineError, which names what wants it, where it is not installed."""
    try:
        return import_module("mujoco")
    except ImportError as error:
        remedy = "install the extra `mujoco` of this project"
        raise MachineError(f"{wanted}: MJCF needs MuJoCo", remedy=remedy) from error


def binary(path: Path) -> Any:
    """Return the `MjModel` of a binary file; raises MachineError where MuJoCo is missing or refuses it."""
    api = mujoco(path)
    try:
        return api.MjModel.from_binary_path(str(path))
    except ValueError as error:
        remedy = f"give its XML, or a file that MuJoCo {api.__version__} wrote"
        raise MachineError(f"{path}: cannot be read", value=str(error)[:120], remedy=remedy) from error


def compiled(text: str, label: str, path: Path | None = None) -> Any:
    """Return an MJCF text as MuJoCo's `MjModel`, with what lies beside its file where there is one.

    Files of meshes may be missing: a body whose mass is stated moves as one without a shape does.

    Raises:
        MachineError: MuJoCo is not installed, or refuses the model.
    """
    api = mujoco(label)
    try:
        return api.MjModel.from_xml_string(text) if path is None else api.MjModel.from_xml_path(str(path))
    except ValueError as error:
        found = _without_meshes(api, text, path) if MISSING in str(error) else None
        if found is not None:
            return found
        remedy = "correct it until MuJoCo loads it; a body with an <inertial> needs no file of its mesh"
        raise MachineError(f"{label}: cannot be read", value=str(error)[:120], remedy=remedy) from error


def _without_meshes(api: ModuleType, text: str, path: Path | None) -> Any:
    """Return the model without its meshes; None where one gives a body its mass, or MuJoCo refuses it still."""
    spec = api.MjSpec.from_string(text) if path is None else api.MjSpec.from_file(str(path))
    shapes = [geom for geom in spec.geoms if geom.type == api.mjtGeom.mjGEOM_MESH]
    if not all(geom.parent.explicitinertial for geom in shapes):
        return None
    for part in (*shapes, *spec.meshes):
        spec.delete(part)
    try:
        return spec.compile()
    except ValueError:
        return None
