"""A small rclpy executor: wait sets built once, raw messages taken until the queue is empty, ticks of the clock grid.

rclpy's own executor builds a new wait set and one task per message at every spin, which costs more than the rest of
the control loop. This one keeps its wait sets until an entity comes or goes (rclpy then triggers the guard condition)
and hands the raw bytes straight to the codec. A control loop waits only for the topics that carry a stream. Silent
topics, services, timers, clients, guard conditions and event handlers are looked at every `LOOK_NS`; all of these but
the topics go through rclpy's own takers. The executor has one thread, or one at a time (`relief`), and raises what a
callback raises.
"""

from __future__ import annotations

import select
from collections.abc import Callable
from contextlib import ExitStack, nullcontext
from time import monotonic_ns, sleep
from typing import Any

from rclpy.event_handler import EventHandler
from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.task import Task

from sher3_runtime.clock import NEVER_NS, Clock
from sher3_runtime.composed.composition import Composition
from sher3_runtime.composed.relief import Relief
from sher3_runtime.composed.turn import Turn
from sher3_runtime.ports import Subscribed, clock_of, ports
from sher3_runtime.tick import Tick, run_due

IDLE_NS = 100_000_000
"""Longest wait [ns]: a shutdown that wakes nobody is noticed after this time."""
LOOK_NS = 8_000_000
"""Period [ns] at which a process that wakes up at the control rate looks at everything that is no stream.

A stream that begins at 1 kHz has eight samples in its queue of ten by then.
"""
_NEAR = 2
"""Periods within which a tick is near: of a tick that its samples have spared (`Tick.done`) the next one is."""
QUIET_NS = 100_000_000
"""A topic that was silent for this long [ns] counts as no stream, until its next sample."""


Take = Callable[[Any], Any]
Entity = tuple[Any, Take, Turn | None]
"""What a callback comes from, its taker, and the turn of its node."""


class _Topic:
    """A subscription as the hot path needs it; `heard_ns` is the time of its newest sample."""

    __slots__ = ("deliver", "handle", "heard_ns", "raw", "subscribed", "take", "type")

    def __init__(self, subscription: Any, deliver: Callable[[Any], None], subscribed: Subscribed) -> None:
        self.subscribed = subscribed
        self.handle = subscription.handle
        self.take = subscription.handle.take_message
        self.type, self.raw, self.deliver = subscription.msg_type, subscription.raw, deliver
        self.heard_ns = monotonic_ns()

    def drain(self) -> bool:
        """Take and deliver every waiting sample; return whether there was one.

        Once the sample of a tick has come, another one is asked for at the next spin: in vain it costs 4 us.
        """
        take, kind, raw = self.take, self.type, self.raw
        if (taken := take(kind, raw)) is None:
            return False
        while taken is not None:
            self.deliver(taken[0])
            if self.subscribed.served:
                break
            taken = take(kind, raw)
        self.heard_ns = monotonic_ns()
        return True


class RawExecutor(Executor):
    """Runs the callbacks of its nodes in the calling thread, topics before ticks."""

    def __init__(self, *, context: Any = None) -> None:
        super().__init__(context=context)
        self.relief: Relief | None = None
        self._held = ExitStack()
        self._wait_set: Any = None
        self._stream_set: Any = None
        self._stale = True
        self._add: list[tuple[Callable[[Any], object], Any]] = []
        self._compositions: list[Composition] = []
        self._topics: dict[int, _Topic] = {}
        self._streams: list[_Topic] = []
        self._others: list[tuple[str, list[Entity]]] = []
        self._waitables: list[Any] = []
        self._ticks: list[Tick] = []
        self._files: dict[int, Callable[[], None]] = {}
        self._clock_of_ticks: Clock | None = None
        self._period_ns, self._paced = IDLE_NS, False
        self._events: list[Any] = []
        self._asked: list[Any] = []
        self._events_due_ns = self._topics_due_ns = self._look_due_ns = 0

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait until something is ready or due, at most `timeout_sec`, and run all of it."""
        if self._stale:
            self._rebuild()
        timeout = IDLE_NS if timeout_sec is None or timeout_sec < 0 else min(int(timeout_sec * 1e9), IDLE_NS)
        now, clock = monotonic_ns(), self._clock_of_ticks
        if clock is not None:
            timeout = max(0, min(timeout, self._next_due() - clock.offset_ns - now))
        if self._files:
            self._wait_on_files(timeout)
            now, timeout = monotonic_ns(), 0
        if not self._files or now >= self._topics_due_ns:
            self._topics_due_ns = now + self._period_ns
            self._wait_and_run(timeout, now)
        if clock is not None:
            run_due(self._ticks, clock)
        for composition in self._compositions:
            composition.flush()

    def work(self) -> float:
        """Deliver what has come and run the ticks that are due, without waiting; what a stand-in does (`relief`).

        Returns:
            Time until the next tick [s].
        """
        for topic in self._topics.values():
            topic.drain()
        clock = self._clock_of_ticks
        if clock is None:
            return IDLE_NS * 1e-9
        run_due(self._ticks, clock)
        for composition in self._compositions:
            composition.flush()
        return (self._next_due() - clock.now()) * 1e-9

    def _next_due(self) -> int:
        """Return when the next tick is due [ns], ticks of nodes at work left out."""
        return min([tick.due_ns for tick in self._ticks if tick.turn is None or not tick.turn.taken], default=NEVER_NS)

    def _asleep(self, wait: Callable[..., Any], *arguments: Any) -> Any:
        """Wait so that a node in the hands of a stand-in can go on meanwhile."""
        if self.relief is None or not self.relief.away:
            return wait(*arguments)
        with self.relief.at_rest():
            return wait(*arguments)

    def _wait_and_run(self, timeout_ns: int, now: int) -> None:
        """Wait for the streams, or every `LOOK_NS` for everything, and run what is ready."""
        left = self._look_due_ns - now
        # Where the next tick is near, the look comes behind it, and costs no wake-up of its own.
        near = self._paced and timeout_ns <= _NEAR * self._period_ns
        if left <= 0 or (timeout_ns > left and not self._streams and not near):
            self._wait(timeout_ns)
            self._take_topics()
            self._run_others()
            self._look_due_ns = now + LOOK_NS
            topics = self._topics.values()
            self._streams = [t for t in topics if now - t.heard_ns < QUIET_NS or t.subscribed.urgent]
            return
        if timeout_ns > 0:
            self._wait_for_streams(timeout_ns if near else min(timeout_ns, left))
        for topic in self._streams:
            topic.drain()

    def _wait_for_streams(self, timeout_ns: int) -> None:
        waking = [topic.handle for topic in self._streams if topic.subscribed.wakes]
        if not waking:
            self._asleep(sleep, timeout_ns * 1e-9)
            return
        wait_set = self._stream_set
        wait_set.clear_entities()
        for handle in waking:
            wait_set.add_subscription(handle)
        self._asleep(wait_set.wait, timeout_ns)

    def settle(self) -> bool:
        """Run what is ready now, without waiting; return whether there was anything (for stepped time)."""
        if self._stale:
            self._rebuild()
        for composition in self._compositions:
            composition.flush()
        files = bool(self._files) and self._wait_on_files(0)
        self._wait(0)
        topics = self._take_topics()
        return self._run_others() or topics or files

    def spin_once_until_future_complete(self, future: Any, timeout_sec: Any = None) -> None:
        """Spin once; part of the Executor interface."""
        future.add_done_callback(lambda _: self.wake())
        self.spin_once(getattr(timeout_sec, "timeout", timeout_sec))

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Release all entities."""
        self._held.close()
        return super().shutdown(timeout_sec)

    def wake(self) -> None:
        """Note that an entity came or went, and wake the wait."""
        self._stale = True
        super().wake()

    def add_node(self, node: Node) -> bool:
        """Run the callbacks of a node from now on."""
        self._stale = True
        return super().add_node(node)

    def remove_node(self, node: Node) -> None:
        """Stop running the callbacks of a node and release its entities at once."""
        super().remove_node(node)
        self._held.close()
        self._stale = True

    # The wait set.

    def _rebuild(self) -> None:
        """Collect every entity of every node and size the wait set for them."""
        self._held.close()
        nodes = self.get_nodes()
        self._stale = False
        self._topics, self._streams, self._look_due_ns = {}, [], 0
        others: dict[str, list[Entity]] = {"guard_condition": [], "service": [], "timer": [], "client": []}
        for node in nodes:
            port = ports(node)
            for sub in node.subscriptions:
                pointer = sub.handle.pointer
                if pointer not in port.polled and self._hold(sub.handle):
                    subscribed = port.subscribed.get(pointer) or Subscribed()
                    self._topics[pointer] = _Topic(sub, port.deliveries.get(pointer, sub.callback), subscribed)
            for kind, entities, take in (
                ("service", node.services, self._take_service),
                ("timer", node.timers, self._take_ready_timer),
                ("client", node.clients, self._take_client),
                ("guard_condition", node.guards, self._take_guard_condition),
            ):
                others[kind] += [(entity, take, port.turn) for entity in entities if self._hold(entity.handle)]
        found = [ports(node).composition for node in nodes]
        self._compositions = list({id(c): c for c in found if c is not None}.values())
        waitables = [waitable for node in nodes for waitable in node.waitables if self._hold(waitable)]
        self._hold(self._context.handle)
        # Our own guard condition only has to wake the wait: `wake` has marked the wait set as stale already.
        guards = [
            guard.handle for guard in (self._guard, self._sigint_gc) if guard is not None and self._hold(guard.handle)
        ]
        self._size_wait_set(guards, others, waitables)
        self._others = [(kind, entities) for kind, entities in others.items() if entities]
        self._schedule(nodes)

    def _hold(self, handle: Any) -> bool:
        """Keep a handle from being destroyed while it is in the wait set."""
        try:
            self._held.enter_context(handle)
        except _rclpy.InvalidHandle:
            return False
        return True

    def _size_wait_set(self, guards: list[Any], others: dict[str, list[Entity]], waitables: list[Any]) -> None:
        subscriptions = [topic.handle for topic in self._topics.values()]
        counts = {kind: len(entities) for kind, entities in others.items()}
        counts["subscription"], counts["event"] = len(subscriptions), 0
        counts["guard_condition"] += len(guards)
        for waitable in waitables:
            more = waitable.get_num_entities()
            for kind in counts:
                counts[kind] += getattr(more, f"num_{kind}s")
        order = ("subscription", "guard_condition", "timer", "client", "service", "event")
        wait_set = _rclpy.WaitSet(*(counts[kind] for kind in order), self._context.handle)
        self._add = [(wait_set.add_subscription, handle) for handle in subscriptions]
        self._add += [(wait_set.add_guard_condition, handle) for handle in guards]
        for kind, entities in others.items():
            add = getattr(wait_set, f"add_{kind}")
            self._add += [(add, entity.handle) for entity, _, _ in entities]
        # Most waitables are event handlers nobody waits for; the others (actions) are worth their place.
        self._events = [waitable for waitable in waitables if isinstance(waitable, EventHandler)]
        self._waitables = [waitable for waitable in waitables if waitable not in self._events]
        self._add += [(waitable.add_to_wait_set, wait_set) for waitable in self._waitables]
        self._wait_set = wait_set
        self._stream_set = _rclpy.WaitSet(max(1, len(subscriptions)), 0, 0, 0, 0, 0, self._context.handle)

    def _schedule(self, nodes: list[Node]) -> None:
        ticks = [tick for node in nodes for tick in ports(node).ticks]
        for tick in ticks:
            if tick.due_ns == 0:
                tick.schedule()
        self._ticks = sorted(ticks, key=lambda tick: tick.phase_ns)
        self._files = {file.fileno(): callback for node in nodes for file, callback in ports(node).readables}
        self._period_ns = min((clock_of(node).period_ns for node in nodes), default=IDLE_NS)
        self._clock_of_ticks = clock_of(nodes[0]) if ticks and not clock_of(nodes[0]).stepped else None
        self._paced = self._clock_of_ticks is not None and self._period_ns <= LOOK_NS

    # One spin.

    def _wait(self, timeout_ns: int) -> None:
        wait_set = self._wait_set
        wait_set.clear_entities()
        for add, handle in self._add:
            add(handle)
        if self._events and (now := monotonic_ns()) > self._events_due_ns:
            self._events_due_ns = now + IDLE_NS
            for event in self._events:
                event.add_to_wait_set(wait_set)
            self._asked = self._waitables + self._events
        else:
            self._asked = self._waitables
        self._asleep(wait_set.wait, timeout_ns)

    def _wait_on_files(self, timeout_ns: int) -> bool:
        """Wait on the files instead of the wait set.

        The wait is no longer than a period, since the topics are only looked at afterwards.
        """
        seconds = min(timeout_ns, self._period_ns) * 1e-9
        readable, _, _ = self._asleep(select.select, self._files, (), (), seconds)
        # Several files may share a callback, which serves them all.
        for callback in dict.fromkeys([self._files[number] for number in readable]):
            callback()
        return bool(readable)

    def _take_topics(self) -> bool:
        ready, topics = self._wait_set.get_ready_entities("subscription"), self._topics
        for pointer in ready:
            topics[pointer].drain()
        return bool(ready)

    def _run_others(self) -> bool:
        """Run services, timers, clients, guard conditions and event handlers through rclpy's own takers."""
        wait_set, anything = self._wait_set, False
        for kind, entities in self._others:
            if ready := wait_set.get_ready_entities(kind):
                for entity, take, turn in entities:
                    if entity.handle.pointer in ready and (turn is None or not turn.taken):
                        anything = True
                        with turn or nullcontext():
                            self._run(take(entity))
        for waitable in self._asked:
            if waitable.is_ready(wait_set):
                anything = True
                self._run(self._take_waitable(waitable))
        if self._tasks:
            anything = True
            self._run_tasks()
        return anything

    def _run(self, work: Any) -> None:
        if work is not None:
            task = Task(work, executor=self)
            task()
            if task.done():
                task.result()

    def _run_tasks(self) -> None:
        """Run the tasks that a future has woken or that `create_task` was given."""
        with self._tasks_lock:
            tasks, self._tasks = self._tasks, []
        for task, _, _ in tasks:
            task()
            if task.done():
                task.result()

    def _take_ready_timer(self, timer: Any) -> Any:
        return self._take_timer(timer) if timer.handle.is_timer_ready() else None
