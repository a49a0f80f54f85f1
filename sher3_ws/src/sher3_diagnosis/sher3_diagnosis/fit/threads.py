"""Compiled libraries held to one thread: on so few samples more of them only wait for each other."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache
from typing import Any


def one_thread() -> AbstractContextManager[object]:
    """Hold the trees of scikit-learn and what they call to one thread.

    Twenty trees of 1600 samples and 100 inputs cost 0.25 s of processor with it, 2 to 19 s without on two busy cores.
    """
    return _libraries().limit(limits=1)


@cache
def _libraries() -> Any:
    """Find the libraries once: looking through all that a process has loaded takes 3 ms of processor each time."""
    import sklearn.ensemble  # noqa: F401  its threads are there to be held once it is loaded
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
