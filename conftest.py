"""What holds for all tests: one thread a process, rare garbage collection, marks found without reading every file."""

import ctypes
import gc
import os

import psutil
import pytest

# Two processes of tests share two cores: more threads of a library only wait for each other. The diagnosis of three
# cases takes 8.4 s of processor with this, 13.6 s without, beside a load of 8.
for _library in ("OMP", "OPENBLAS"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

# Modules and thousands of collected tests are no garbage; looking at them again and again is 6 % of the processor time.
gc.set_threshold(50_000, 20, 50)

GROWTH = 300e6
"""Bytes that a process may grow by before it gives back what no test needs: the C library keeps the arrays of every
diagnosis for the next one, 250 of 500 MB after five cases."""
_memory = psutil.Process().memory_info
_give_back = getattr(ctypes.CDLL(None), "malloc_trim", int)  # other C libraries than GNU's give it back themselves
_size = {"bytes": float("inf")}


def pytest_collection_finish() -> None:
    """Leave out of every later collection what is there before the first test."""
    gc.freeze()
    _size["bytes"] = _memory().rss


def pytest_runtest_logfinish() -> None:
    """Collect the garbage of a process that has grown, and give its memory back."""
    if _memory().rss > _size["bytes"] + GROWTH:
        gc.collect()
        _give_back(0)
        _size["bytes"] = _memory().rss


def pytest_configure(config: pytest.Config) -> None:
    """Let the second of two workers read the files backwards: what one has compiled by then, the other need not."""
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw1" and config.args_source is config.ArgsSource.TESTPATHS:
        config.args.reverse()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the tests of all workers into one order, and refuse one in wall time whose file does not name its mark.

    `make test` looks for that word before it reads.
    """
    if config.args_source is config.ArgsSource.TESTPATHS:
        order = {config.rootpath / path: k for k, path in enumerate(config.getini("testpaths"))}
        first = {path: next(order[p] for p in path.parents if p in order) for path in {item.path for item in items}}
        items.sort(key=lambda item: first[item.path])
    paths = {item.path for item in items if item.get_closest_marker("flaky")}
    hidden = sorted(str(path) for path in paths if "flaky" not in path.read_text())
    if hidden:
        raise pytest.UsageError(f"mark tests in wall time where they stand, pytest.mark.flaky: {hidden}")
