"""Logs diagnosed one by one, on this machine or a cluster."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from sher3_common.errors import Sher3Error
from sher3_common.progress import Say, silent
from sher3_public.guard.baseline import Entry
from sher3_public.guard.worse import Worse


@dataclass(frozen=True)
class Log:
    """One log and the model it is held against; paths as the worker sees them."""

    log: Path
    model: Path
    without: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Its name in a baseline: the file's, without the ending."""
        return self.log.resolve().name if self.log.is_dir() else self.log.stem

    def absolute(self) -> Log:
        """Return it with paths that do not depend on the working folder."""
        return replace(self, log=self.log.resolve(), model=self.model.resolve())


@dataclass(frozen=True)
class LogAnswer:
    """What a log says: its headline and entry, or the error that stopped it; `worse` once it was compared."""

    task: Log
    entry: Entry | None = None
    headline: str = ""
    error: Sher3Error | None = None
    worse: tuple[Worse, ...] = ()


def answered(log: Log, say: Say = silent) -> LogAnswer:
    """Diagnose one log; input errors come back as the answer, mistakes of ours are raised."""
    from sher3_public.guard.baseline import entry_of
    from sher3_public.one_call import diagnose

    say(f"reading {log.log}")
    try:
        found = diagnose(log.model, log.log, without=log.without)
    except Sher3Error as error:
        return LogAnswer(log, error=error)
    return LogAnswer(log, entry_of(found.diagnosis), found.headline)
