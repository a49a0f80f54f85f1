"""Verdicts read from files, of any machine."""

from __future__ import annotations

from pathlib import Path

from sher3_common import FileError
from sher3_diagnosis.verdict import Verdict

from sher3_export.errors import ExportError


def read_verdict(path: Path) -> Verdict:
    """Read a verdict file; raises ExportError where it cannot be read or is none."""
    remedy = "name the verdict.json of `sher3 gap diagnose`"
    try:
        return Verdict.read(path)
    except FileError as error:
        raise ExportError(str(error.what), value=error.value, limit=error.limit, remedy=remedy) from error
    except ValueError as error:
        reason = str(error).splitlines()[0]
        raise ExportError(f"{path}: is not a verdict", value=reason, limit="sher3.verdict", remedy=remedy) from error
