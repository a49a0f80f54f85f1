"""Many tasks on this machine or on a cluster; answers come as they are ready."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from typing import Any, Protocol, TypeVar

from sher3_common.progress import Say

from sher3_gap_cli.options import RequestError


class Task(Protocol):
    """What a worker is given."""

    def absolute(self) -> Any:
        """Return it with paths that do not depend on the working folder."""


Found = TypeVar("Found")
"""What a worker hands back: a frozen dataclass with the task in `task`."""


def run_here(work: Callable[..., Found], tasks: Sequence[Task], jobs: int, say: Say) -> Iterator[Found]:
    """Work on this machine, `jobs` tasks at a time; alone it tells its steps by `say`."""
    if jobs == 1 or len(tasks) == 1:
        for task in tasks:
            yield work(task, say)
        return
    from joblib import Parallel, delayed

    parallel = Parallel(n_jobs=min(jobs, len(tasks)), return_as="generator_unordered")
    yield from parallel(delayed(work)(task) for task in tasks)


def run_on_dask(work: Callable[..., Any], tasks: Sequence[Task], address: str, timeout: float = 10.0) -> Iterator[Any]:
    """Work on a Dask cluster whose workers see the files under the same paths.

    Raises:
        RequestError: no scheduler answers at the address.
    """
    from distributed import Client, as_completed

    try:
        client = Client(address, timeout=timeout)
    except (OSError, ValueError, TimeoutError) as error:
        remedy = "start one with `dask scheduler --host 127.0.0.1`"
        raise RequestError("no Dask scheduler answers", value=address, limit=f"{timeout:g} s", remedy=remedy) from error
    with closing(client):
        futures = client.map(work, [task.absolute() for task in tasks], pure=False)
        back = dict(zip((f.key for f in futures), tasks, strict=True))
        for future in as_completed(futures):
            yield replace(future.result(), task=back[future.key])
