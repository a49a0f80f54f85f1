"""The door to MuJoCo, which is an extra: `sher3[mujoco]`. Without it this import fails, and the registry says so."""

from __future__ import annotations

from importlib import import_module
from typing import Any

mujoco: Any = import_module("mujoco")
