"""What was done to records is told once for all of them: of 34 runs nobody reads the same sentence 34 times."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")
"""A number in a sentence, and none in a name; sentences that differ by numbers alone say the same."""
NAMED = 3
"""Runs that are named; of more the number is told."""


def merged(notes: Iterable[str], runs: Sequence[str]) -> list[str]:
    """Return the notes, with one in place of all that say the same of several runs, in the order of the first of them.

    Args:
        notes: sentences; one of a run begins with its name and a colon.
        runs: names of the runs.
    """
    groups: dict[str, dict[str, str]] = {}
    for note in notes:
        run, text = _split(note, runs)
        groups.setdefault(NUMBER.sub("#", text) if run else note, {}).setdefault(run, text)
    return [_together(found) for found in groups.values()]


def _split(note: str, runs: Sequence[str]) -> tuple[str, str]:
    """Return the run that a note is on, and what it says; an empty name where it is on none."""
    head, mark, rest = note.partition(": ")
    return (head, rest) if mark and head in runs else ("", note)


def _together(found: dict[str, str]) -> str:
    """Return one note for those of some runs, run -> sentence."""
    runs, text = list(found), next(iter(found.values()))
    if len(runs) == 1:
        return f"{runs[0]}: {text}" if runs[0] else text
    named = ", ".join(runs[:NAMED]) + (f" and {len(runs) - NAMED} more" if len(runs) > NAMED else "")
    same = len(set(found.values())) == 1
    return f"{named}: {text}" + ("" if same else f" (numbers of {runs[0]}; alike in the others)")
