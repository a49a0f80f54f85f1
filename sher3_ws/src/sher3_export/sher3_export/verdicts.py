"""Verdicts read from files, of any machine."""

from __future__ import annotations

from pathlib import Path

from sher3_common import FileError
from sher3_diagnosis.bet import betting
from sher3_diagnosis.verdict import Verdict

from sher3_export.errors import ExportError


def read_verdict(path: Path, bet: bool = False) -> Verdict:
    """Read a verdict file; with `bet` its best bets are its causes, also where it abstains.

    Raises:
        ExportError: it cannot be read or is none.
        NoBetError: a bet is asked for and there is none.
    """
    remedy = "name the verdict.json of `sher3 gap diagnose`"
    try:
        found = Verdict.read(path)
    except FileError as error:
        raise ExportError(str(error.what), value=error.value, limit=error.limit, remedy=remedy) from error
    except ValueError as error:
        reason = str(error).splitlines()[0]
        raise ExportError(f"{path}: is not a verdict", value=reason, limit="sher3.verdict", remedy=remedy) from error
    return betting(found) if bet else found
