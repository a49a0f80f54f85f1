"""`spin(nodes)`: run nodes in this thread until the context is shut down."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from rclpy.executors import Executor, ExternalShutdownException
from rclpy.node import Node
from sher3_common.waiting import let_others_go_on

from sher3_runtime.clock import set_timer_slack
from sher3_runtime.composed.relief import Relief
from sher3_runtime.execution.executor import RawExecutor
from sher3_runtime.ports import STATISTICS_VARIABLE, TRACE_VARIABLE, ports, raw_mode
from sher3_runtime.statistics.baseline import BaselineExecutor
from sher3_runtime.statistics.report import report_statistics


def make_executor(nodes: Iterable[Node], context: Any = None) -> Executor:
    """Return the executor of the mode in force, with the nodes added."""
    executor = RawExecutor(context=context) if raw_mode() else BaselineExecutor(context=context)
    for node in nodes:
        executor.add_node(node)
    return executor


def spin(
    nodes: Sequence[Node],
    *,
    stop: Callable[[], object] = bool,
    meet: Callable[[Executor], None] | None = None,
    leave: Callable[[], None] = lambda: None,
    diagnostics: bool = True,
) -> None:
    """Run `nodes` until `stop()` or shutdown; then close them, while they can still publish.

    Args:
        nodes: Nodes of one context. The `close()` of a node, where it has one, is called at the end, even after an
            error.
        stop: Asked at every spin; true ends the spinning.
        meet: Called once with the executor before the first tick (the start barrier).
        leave: Called once when the nodes are closed, before they leave the middleware.
        diagnostics: Publish the statistics of each node at 1 Hz on `/diagnostics`.

    Raises:
        Exception: Whatever a callback raises.
    """
    executor = relief = None
    try:
        set_timer_slack()
        for node in nodes if diagnostics else ():
            report_statistics(node)
        executor = make_executor(nodes, nodes[0].context)
        if (composition := ports(nodes[0]).composition) is not None:
            composition.begin()
        # What exists now lives to the end; a collection during the run must not walk through it.
        gc.collect()
        gc.freeze()
        if isinstance(executor, BaselineExecutor):
            executor.watch_files()
        if meet is not None:
            meet(executor)
        if isinstance(executor, BaselineExecutor):
            executor.start_ticks()
        if composition is not None and isinstance(executor, RawExecutor):
            # After the meeting: the stand-ins take over the priority of this thread.
            relief = executor.relief = Relief(executor.work)
            relief.start()
            let_others_go_on(relief.others_go_on)
        while nodes[0].context.ok() and not stop():
            # Asking the context takes a lock; a shutdown has time for a few spins.
            for _ in range(20):
                executor.spin_once(0.05)
                if relief is not None and relief.error is not None:
                    raise relief.error
                if stop():
                    break
    except ExternalShutdownException:
        pass
    finally:
        let_others_go_on(None)
        if relief is not None:
            relief.stop()
        close(nodes, executor, leave)


def close(nodes: Iterable[Node], executor: Executor | None = None, leave: Callable[[], None] = lambda: None) -> None:
    """Close and destroy nodes in reverse order; each is closed even when the `close()` of another one raises."""
    failure: BaseException | None = None
    for node in reversed(list(nodes)):
        try:
            getattr(node, "close", lambda: None)()
        except Exception as error:
            failure = failure or error
    for node in nodes:
        if (composition := ports(node).composition) is not None:
            composition.flush()
    if folder := os.environ.get(TRACE_VARIABLE) or os.environ.get(STATISTICS_VARIABLE):
        for node in nodes:
            ports(node).statistics.write(Path(folder), node.get_name())
    leave()
    if executor is not None:
        executor.shutdown()
    for node in nodes:
        node.destroy_node()
    if failure is not None:
        raise failure
