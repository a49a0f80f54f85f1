"""Who runs the nodes of a process while one of them waits long for its device.

One thread runs node code at a time: it has the baton. A node that waits (`sher3_common.waiting`) lays the baton down,
and a stand-in takes it up: it runs the ticks that are due and delivers what has come, for all nodes but those that
wait. When the device has answered, the first thread waits for the baton, at most as long as one callback takes, and
goes on. In a healthy tick no stand-in ever runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, Semaphore, Thread, get_ident
from time import sleep

STAND_INS = 3
"""Nodes of a process that may wait at the same time without holding up the others: drives, force sensor, one more."""
LONGEST_REST = 0.001
"""Longest rest [s] of a stand-in, after which it looks for samples again."""


class Relief:
    """The baton of a process and its stand-ins.

    Args:
        work: runs what is due and delivers what has come, without waiting; returns the time until more is due [s].

    Attributes:
        error: what a callback raised in a stand-in; it has to end the process.
    """

    def __init__(self, work: Callable[[], float]) -> None:
        self.error: BaseException | None = None
        self._work = work
        self._baton = Lock()
        self._holder = 0
        self._called = Semaphore(0)
        self._away: list[int] = []
        self._ends = False
        self._threads = [Thread(target=self._stand_in, daemon=True, name=f"stand-in {i}") for i in range(STAND_INS)]

    def start(self) -> None:
        """Take the baton and let the stand-ins be there; their priority is that of this thread."""
        self._take()
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """End the stand-ins; a node that waits comes back first."""
        self._ends = True
        for _ in self._threads:
            self._called.release()
        self._lay_down()
        for thread in self._threads:
            thread.join(1.0)

    @property
    def away(self) -> bool:
        """Whether a node is in the hands of another thread: then nobody may sleep with the baton."""
        return bool(self._away)

    @contextmanager
    def others_go_on(self) -> Iterator[None]:
        """Let a stand-in run the other nodes; for the thread that has the baton, and nothing for any other."""
        if self._holder != get_ident():
            yield
            return
        self._away.append(self._holder)
        self._lay_down()
        self._called.release()
        try:
            yield
        finally:
            self._take()
            self._away.remove(self._holder)

    @contextmanager
    def at_rest(self) -> Iterator[None]:
        """Sleep without the baton."""
        self._lay_down()
        try:
            yield
        finally:
            self._take()

    def _take(self) -> None:
        self._baton.acquire()
        self._holder = get_ident()

    def _lay_down(self) -> None:
        self._holder = 0
        self._baton.release()

    def _stand_in(self) -> None:
        while not self._ends:
            self._called.acquire()
            rest = 0.0
            while self._away and not self._ends and self.error is None:
                self._take()
                try:
                    rest = self._work()
                except BaseException as error:  # whatever it is, the process has to end for it
                    self.error = error
                finally:
                    self._lay_down()
                sleep(min(max(rest, 0.0), LONGEST_REST))
