"""Waiting for a device inside a tick: the one place where a node holds up whoever shares its process.

A device that works answers within a fraction of a period, now and then in most of one where the machine is busy. For
that long the wait is an ordinary one: to let others work costs two changes of thread, and the node gets its turn back
only when theirs has ended. A device that stayed away the last time is waited for in place for a moment only; then the
others in the process go on without the node that waits.
"""

from __future__ import annotations

import select
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager

IN_PLACE = 0.3
"""Share of the longest wait after which the others in the process go on when the device was silent last time, ..."""
MOST_IN_PLACE = 0.002
"""... but not later than after this time [s], whatever the device did."""

Relief = Callable[[], AbstractContextManager[object]]
_relief: list[Relief] = []
_silent: set[tuple[int, ...]] = set()
"""Descriptors that nothing came from while they were waited on the last time."""


def let_others_go_on(relief: Relief | None) -> None:
    """Say what lets the others in this process work while its context is entered; None where there are none."""
    _relief[:] = [] if relief is None else [relief]
    _silent.clear()


def wait_readable(files: Iterable[int], timeout: float) -> list[int]:
    """Return those of `files` (descriptors) that can be read; wait at most `timeout` s for the first.

    `select` is used because its timeout resolves microseconds; that of `poll` resolves milliseconds, which is a whole
    control period.
    """
    if not _relief or timeout <= 0.0:
        return select.select(files, (), (), max(timeout, 0.0))[0]
    device = tuple(files)
    in_place = min(IN_PLACE * timeout if device in _silent else timeout, MOST_IN_PLACE)
    ready = select.select(device, (), (), in_place)[0]
    if not ready and in_place < timeout:
        with _relief[0]():
            ready = select.select(device, (), (), timeout - in_place)[0]
    (_silent.discard if ready else _silent.add)(device)
    return ready
