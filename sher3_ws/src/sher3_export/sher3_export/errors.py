"""The errors of this package."""

from __future__ import annotations

from sher3_common import Sher3Error


class ExportError(Sher3Error):
    """A model or a case that a verdict cannot be written into or checked on."""


class MujocoMissing(ExportError):
    """MuJoCo is not installed."""

    def __init__(self) -> None:
        super().__init__("MuJoCo is not installed", remedy="install the extra `mujoco` of this project")
