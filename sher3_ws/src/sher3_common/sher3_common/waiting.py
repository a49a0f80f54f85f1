"""Waiting for a device inside a tick: the one place where a node holds up whoever shares its process.

A device answers within a fraction of a period, and for that long the wait is an ordinary one: to let others work would
cost more. Where the answer takes longer, the others in the process go on without the node that waits.
"""

from __future__ import annotations

import select
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager

IN_PLACE = 0.3
"""Share of the longest wait after which the others in the process go on, ..."""
MOST_IN_PLACE = 0.002
"""... but not later than after this time [s]."""

Relief = Callable[[], AbstractContextManager[object]]
_relief: list[Relief] = []


def let_others_go_on(relief: Relief | None) -> None:
    """Say what lets the others in this process work while its context is entered; None where there are none."""
    _relief[:] = [] if relief is None else [relief]


def wait_readable(files: Iterable[int], timeout: float) -> list[int]:
    """Return those of `files` (descriptors) that can be read; wait at most `timeout` s for the first.

    `select` is used because its timeout resolves microseconds; that of `poll` resolves milliseconds, which is a whole
    control period.
    """
    if not _relief or timeout <= 0.0:
        return select.select(files, (), (), max(timeout, 0.0))[0]
    in_place = min(IN_PLACE * timeout, MOST_IN_PLACE)
    ready = select.select(files, (), (), in_place)[0]
    if not ready:
        with _relief[0]():
            ready = select.select(files, (), (), timeout - in_place)[0]
    return ready
