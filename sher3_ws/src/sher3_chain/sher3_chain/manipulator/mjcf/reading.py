"""An MJCF file by MuJoCo's own loader (an extra): defaults, includes and mesh inertias are resolved as MuJoCo does."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from sher3_machines.errors import MachineError

MAX_BYTES = 20_000_000
"""Largest model file that is read."""


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


def compiled(text: str, label: str, path: Path | None = None) -> Any:
    """Return an MJCF text as MuJoCo's `MjModel`, with what lies beside its file where there is one.

    Raises:
        MachineError: MuJoCo is not installed, or refuses the model.
    """
    api = mujoco(label).MjModel
    try:
        return api.from_xml_string(text) if path is None else api.from_xml_path(str(path))
    except ValueError as error:
        remedy = "correct it until MuJoCo loads it"
        raise MachineError(f"{label}: cannot be read", value=str(error)[:120], remedy=remedy) from error
