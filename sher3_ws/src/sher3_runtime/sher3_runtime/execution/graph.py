"""A graph in one process and in stepped time, for tests: nothing depends on the load of the machine.

Use it as a context manager: `with Graph() as graph: graph.add(ForceSensorNode, device); graph.step(100)`.
Samples go by the middleware, or by the `post` of the graph, which takes half of the time or less.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import partial
from itertools import groupby
from types import TracebackType
from typing import Any, TypeVar

from rclpy.context import Context
from rclpy.node import Node
from sher3_common import Sher3Error
from sher3_description import TOPICS

from sher3_runtime import environment
from sher3_runtime.clock import SteppedClock, set_timer_slack
from sher3_runtime.composed.composition import Composition
from sher3_runtime.domains import own_domain
from sher3_runtime.execution.executor import RawExecutor
from sher3_runtime.execution.spinning import close
from sher3_runtime.ports import NODE_OPTIONS, advertise, forget, ports, raw_mode, subscribe, use_clock, use_post
from sher3_runtime.post import Post
from sher3_runtime.tick import Tick

N = TypeVar("N", bound=Node)
V = TypeVar("V")
Route = tuple[str, list[dict[str, V]], list[dict[str, V]]]
"""A topic and what its senders and its receivers note, by topic."""


class NotSettled(Sher3Error):
    """A sample that was sent did not arrive within the time limit."""


class Graph:
    """Nodes with a context, a domain and a stepped clock of their own.

    Args:
        period: of the clock [s].
        domain: of the middleware; by default one that nobody else has.
        patience: how long a sample may be on its way [s].
        middleware: whether samples go by the middleware. If not, services and discovery alone do.

    Attributes:
        clock: the stepped clock, shared by all nodes of the graph.
        nodes: the nodes in the order they were added.
    """

    def __init__(
        self, period: float = 0.002, domain: int | None = None, patience: float = 10.0, middleware: bool = True
    ) -> None:
        environment.apply()
        # An empty wait lasts as long as the slack.
        set_timer_slack()
        self.context = Context()
        self.context.init(domain_id=own_domain() if domain is None else domain)
        self.clock = SteppedClock(round(period * 1e9))
        use_clock(self.context, self.clock)
        self._post = None if middleware or not raw_mode() else Post()
        if self._post is not None:
            use_post(self.context, self._post)
        self.executor = RawExecutor(context=self.context)
        self.nodes: list[Node] = []
        self._paused: list[Node] = []
        self._compositions: set[Composition] = set()
        self._patience = patience
        self._matched = False
        self._routes: list[Route[int]] = []
        self._latches: list[Route[deque[bytes]]] = []
        self._stamp = self.clock.start_ns

    def add(self, factory: Callable[..., N], *arguments: Any, **settings: Any) -> N:
        """Add the node that `factory(*arguments, context=..., **settings)` returns."""
        return self._add(partial(factory, *arguments, **settings), None)

    def add_to(self, composition: Composition, factory: Callable[..., N], *arguments: Any, **settings: Any) -> N:
        """Add a node, as `add` does, to the nodes of one process, which hear each other without the middleware."""
        return self._add(partial(factory, *arguments, **settings), composition)

    def _add(self, factory: Callable[..., N], composition: Composition | None) -> N:
        with composition or nullcontext():
            node = factory(context=self.context)
            ports(node)
        if composition is not None:
            composition.begin()
            self._compositions.add(composition)
        self.nodes.append(node)
        self.executor.add_node(node)
        self._matched = False
        self._find_routes()
        self._expect_nothing(node)
        return node

    def probe(self, *topics: str, sends: tuple[str, ...] = ()) -> Probe:
        """Add a node that keeps every sample of `topics` and can publish on the topics `sends`."""
        return self.add(Probe, *topics, name=f"probe_{len(self.nodes)}", sends=sends)

    def step(self, count: int = 1) -> int:
        """Run `count` ticks of all nodes in the order of their phases; return the stamp of the last one.

        Ticks of one phase run in the order in which their nodes were added; then every sample is delivered.
        """
        return list(self.steps(count))[-1]

    def steps(self, count: int) -> Iterator[int]:
        """Run ticks as `step` does; give the stamp of each after it. Services are served before the first one."""
        if not self._matched:
            self._match()
        if self._post is not None:
            self.executor.settle()  # services
        for _ in range(count):
            stamp = self._stamp
            self._stamp += self.clock.period_ns
            ticks = [tick for node in self.nodes for tick in ports(node).ticks if stamp % tick.period_ns == 0]
            for phase, together in groupby(sorted(ticks, key=_phase), key=_phase):
                self.clock.time_ns = stamp + phase
                for tick in together:
                    tick.due_ns = self.clock.time_ns
                    tick.run(self.clock.time_ns)
                self.settle()
            yield stamp

    def pause(self, node: Node) -> None:
        """Stop a node as SIGSTOP stops its process: no tick, no callback; nodes of the same process stop with it.

        What is sent to the node waits in its queues.
        """
        for one in self._process_of(node, self.nodes):
            self.nodes.remove(one)
            self._paused.append(one)
            self.executor.remove_node(one)
            self._hold(one, True)
        self._find_routes()

    def resume(self, node: Node) -> None:
        """Let a paused node go on: it gets first what waits in its queues; what did not fit into them is lost."""
        process = self._process_of(node, self._paused)
        for one in process:
            self.executor.add_node(one)
            self._hold(one, False)
        while self.executor.settle():
            pass
        if self._post is not None:
            self._deliver(self._post)
        for one in process:
            self._paused.remove(one)
            self.nodes.append(one)
        self._find_routes()
        for one in process:
            self._expect_nothing(one)

    @staticmethod
    def _process_of(node: Node, among: list[Node]) -> list[Node]:
        """Return the nodes of the process of `node`."""
        composition = ports(node).composition
        return [one for one in among if one is node or (composition and ports(one).composition is composition)]

    def _expect_nothing(self, node: Node) -> None:
        """Count what was sent until now as received by a node that did not exist then."""
        received = ports(node).received
        for name, sent, _ in self._routes:
            if name in received:
                received[name] = sum(counts[name] for counts in sent)

    def jump(self, seconds: float) -> None:
        """Let the clock of all nodes jump by whole periods, as when the system time is set."""
        self._stamp += round(seconds * 1e9 / self.clock.period_ns) * self.clock.period_ns

    def settle(self) -> None:
        """Run callbacks until every sample that was sent has been received and nothing is ready.

        Raises:
            NotSettled: a sample is still missing after `patience` seconds.
        """
        if self._post is not None:
            self._deliver(self._post)
            return
        deadline = time.monotonic() + self._patience
        while self.executor.settle() or self._missing():
            if time.monotonic() > deadline:
                remedy = "check the quality of service and the depth of the queues"
                raise NotSettled("samples not received", value=self._missing(), limit=self._patience, remedy=remedy)

    def _deliver(self, post: Post) -> None:
        """Deliver all that the post has, and what nodes of a common process still have to let out."""
        for composition in self._compositions:
            composition.flush()
        while post.deliver():
            for composition in self._compositions:
                composition.flush()

    def _hold(self, node: Node, held: bool) -> None:
        if self._post is not None:
            self._post.hold(list(ports(node).boxes.values()), held)

    def until(self, condition: Callable[[], bool], what: str = "condition") -> None:
        """Settle until `condition()` is true: for what the middleware does in its own time (services, latched samples).

        Raises:
            NotSettled: The condition is not true after `patience` seconds.
        """
        deadline = time.monotonic() + self._patience
        while not condition():
            if time.monotonic() > deadline:
                raise NotSettled(f"{what} not met", limit=self._patience, remedy="check the sender")
            self.executor.settle()
            self.settle()
            time.sleep(0.0005)

    def _missing(self) -> dict[str, int]:
        """Return the number of samples on the way, by topic; of a latched topic, of readers without its last sample."""
        missing = {}
        for name, sent, received in self._routes:
            # Written out: this is asked some five times a tick.
            on_the_way = 0
            for counts in sent:
                on_the_way += counts[name]
            on_the_way *= len(received)
            for counts in received:
                on_the_way -= counts[name]
            if on_the_way:
                missing[name] = on_the_way
        return missing or self._not_up_to_date()

    def _not_up_to_date(self) -> dict[str, int]:
        """Return how many readers of a latched topic have no sample, or one that its sender has replaced since.

        A stranger's sample, which may take the place of the last one in a reader's queue, counts as up to date.
        """
        late = {}
        for name, sent, received in self._latches:
            newest = [samples[name][-1] for samples in sent if samples[name]]
            behind = [got for got in received if not got[name] or got[name][-1] not in newest]
            if newest and behind:
                replaced = {data for samples in sent for data in samples[name]}
                late[name] = sum(not got[name] or got[name][-1] in replaced for got in behind)
        return {name: count for name, count in late.items() if count}

    def _find_routes(self) -> None:
        """Find the two ends of each topic in the graph; what the post delivers at once needs no waiting.

        Samples of a stream are counted. Of a latched topic a reader keeps one, so the last one is compared.
        """
        if self._post is not None:
            return
        senders, receivers = list(map(ports, [*self.nodes, *self._paused])), list(map(ports, self.nodes))
        self._routes = _with_both_ends("volatile", [p.sent for p in senders], [p.received for p in receivers])
        latest = [p.last_sent for p in senders], [p.last_received for p in receivers]
        self._latches = _with_both_ends("transient_local", *latest)

    def _match(self) -> None:
        """Wait until every publisher of the graph has found every subscriber."""
        writers = [(name, pub) for node in self.nodes for name, pub in ports(node).publishers.items()]
        readers = [(name, sub) for node in self.nodes for name, sub in ports(node).subscriptions.items()]
        deadline = time.monotonic() + self._patience
        for name, publisher in writers:
            expected = sum(1 for topic, _ in readers if topic == name)
            _wait(publisher.get_subscription_count, expected, deadline, name)
        for name, reader in readers:
            expected = sum(1 for topic, _ in writers if topic == name)
            _wait(reader.handle.get_publisher_count, expected, deadline, name)
        self._matched = True
        self._find_routes()
        self.settle()  # latched samples that were sent before their readers were found

    def close(self) -> None:
        """Close the nodes and leave the domain."""
        try:
            close([*self.nodes, *self._paused], self.executor)
        finally:
            self.nodes, self._paused = [], []
            self.context.try_shutdown()
            forget(self.context)

    def __enter__(self) -> Graph:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _with_both_ends(durability: str, sent: list[dict[str, V]], received: list[dict[str, V]]) -> list[Route[V]]:
    """Return the routes of the topics of one durability that somebody sends and somebody receives."""
    names = [name for name, topic in TOPICS.items() if topic.qos.durability == durability]
    routes = [(name, [by for by in sent if name in by], [by for by in received if name in by]) for name in names]
    return [route for route in routes if route[1] and route[2]]


def _phase(tick: Tick) -> int:
    return tick.phase_ns


class Probe(Node):
    """A node for tests: `samples[topic]` holds all it received, `send(topic, sample)` publishes."""

    def __init__(self, *topics: str, name: str = "probe", sends: tuple[str, ...] = (), **options: Any) -> None:
        super().__init__(name, **{**NODE_OPTIONS, **options})
        self.samples: dict[str, list[Any]] = {topic: [] for topic in topics}
        for topic in topics:
            subscribe(self, topic, self.samples[topic].append)
        self._publish = {topic: advertise(self, topic) for topic in sends}

    def send(self, topic: str, sample: Any) -> None:
        """Publish a sample on one of the topics given as `sends`."""
        self._publish[topic](sample)


def _wait(count: Callable[[], int], expected: int, deadline: float, name: str) -> None:
    while count() < expected:
        if time.monotonic() > deadline:
            raise NotSettled("publisher and subscriber did not find each other", value=name, remedy="check their QoS")
        time.sleep(0.001)
