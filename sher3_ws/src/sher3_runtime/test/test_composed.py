"""Nodes of one process: who gets what, in which order, what the middleware sees; and no wait holds up the others."""

from __future__ import annotations

import math
import os
import time
from collections import deque
from contextlib import contextmanager

import pytest
from rclpy.context import Context
from rclpy.node import Node
from sher3_common.samples import JointSample, JoySample, TextSample, TwistSample, WrenchSample
from sher3_common.waiting import let_others_go_on, wait_readable
from sher3_description.topics import TOPICS
from sher3_runtime import (
    NODE_OPTIONS,
    Clock,
    Graph,
    advertise,
    latest,
    on_tick,
    spin,
    statistics_of,
    subscribe,
    use_clock,
)
from sher3_runtime.clock import SteppedClock
from sher3_runtime.codec.cdr import as_sent, codec
from sher3_runtime.composed.composition import Composition
from sher3_runtime.composed.outside import Outside
from sher3_runtime.composed.turn import Turn
from sher3_runtime.domains import own_domain
from sher3_runtime.ports import ports
from sher3_runtime.tick import Tick
from sher3_runtime.timing import Statistics

pytestmark = pytest.mark.graph
ZERO = (0.0,) * 6


class Relay(Node):
    """Answers each wrench with a twist, and keeps what it hears."""

    def __init__(self, heard, **options):
        super().__init__("relay", **{**NODE_OPTIONS, **options})
        self.publish = advertise(self, "servo_cv")
        subscribe(
            self, "force/measured_cf", lambda s: (heard.append("wrench"), self.publish(TwistSample(s.stamp, ZERO)))
        )
        subscribe(self, "measured_js", lambda s: heard.append("joints"))


class Source(Node):
    """Publishes wrench and joints in its tick and hears the twist, as the motor driver hears its command."""

    def __init__(self, heard, **options):
        super().__init__("source", **{**NODE_OPTIONS, **options})
        self.heard = heard
        self.wrench, self.joints = advertise(self, "force/measured_cf"), advertise(self, "measured_js")
        subscribe(self, "servo_cv", lambda s: heard.append("twist"))
        on_tick(self, self.tick)

    def tick(self, stamp):
        self.heard.append("tick")
        self.wrench(WrenchSample(stamp, ZERO))
        self.joints(JointSample(stamp, (0.0,) * 5))
        self.heard.append("end")


def two(graph, heard):
    together = Composition()
    relay = graph.add_to(together, Relay, heard)
    return relay, graph.add_to(together, Source, heard)


def test_a_sample_is_there_within_the_tick_and_its_answer_after_it():
    """Depth first: the publisher of the wrench is at work, so the twist waits until its tick has ended."""
    heard = []
    with Graph() as graph:
        two(graph, heard)
        graph.step(3)
    assert heard == ["tick", "wrench", "joints", "end", "twist"] * 3


def test_the_object_itself_arrives_and_outsiders_get_the_same_values():
    with Graph() as graph:
        relay, source = two(graph, [])
        taken = []
        outside = graph.probe("force/measured_cf", "servo_cv")
        subscribed = graph.add_to(ports(relay).composition, Listener, "force/measured_cf", taken.append)
        graph.step(5)
        assert subscribed is not source and len(taken) == 5
        assert outside.samples["force/measured_cf"] == taken
        assert len(outside.samples["servo_cv"]) == 5
        assert statistics_of(relay).age["force/measured_cf"].count == 5


class Listener(Node):
    def __init__(self, name, callback, **options):
        super().__init__(f"listener_{id(callback)}", **{**NODE_OPTIONS, **options})
        subscribe(self, name, callback)


def test_nobody_outside_can_speak_on_a_topic_within_the_process():
    heard = []
    with Graph() as graph:
        two(graph, heard)
        stranger = graph.probe(sends=("servo_cv",))
        graph.step(2)
        stranger.send("servo_cv", TwistSample(1, ZERO))
        graph.settle()
    assert heard.count("twist") == 2


def test_latched_samples_wait_for_nodes_that_come_later_and_only_the_last_one():
    heard = []

    class Settings(Node):
        def __init__(self, **options):
            super().__init__("settings", **{**NODE_OPTIONS, **options})
            publish = advertise(self, "admittance/settings")
            publish(TextSample("first"))
            publish(TextSample("second"))

    with Graph() as graph:
        together = Composition()
        graph.add_to(together, Settings)
        graph.add_to(together, Listener, "admittance/settings", lambda s: heard.append(s.text))
        graph.step(1)
    assert heard == ["second"]


def test_the_newest_sample_can_be_looked_at():
    with Graph() as graph:
        relay, _ = two(graph, [])
        looker = graph.add_to(ports(relay).composition, Looker)
        assert looker.take() is None
        graph.step(3)
        assert looker.take().position == (0.0,) * 5
        assert looker.take() is None


class Looker(Node):
    def __init__(self, **options):
        super().__init__("looker", **{**NODE_OPTIONS, **options})
        self.take = latest(self, "measured_js")


def test_nodes_that_look_at_the_same_topic_from_outside_share_one_subscription():
    """Each gets every sample, whichever of them asks the middleware."""
    with Graph() as graph:
        outside, together = graph.probe(sends=("measured_js",)), Composition()
        lookers = [graph.add_to(together, Looker) for _ in range(3)]
        assert sum("measured_js" in ports(looker).subscriptions for looker in lookers) == 1
        graph.step()
        for stamp in (1, 2):
            outside.send("measured_js", JointSample(stamp, (0.0,) * 5))
            graph.settle()
            assert [looker.take().stamp for looker in lookers] == [stamp] * 3
            assert [looker.take() for looker in lookers] == [None] * 3


def test_a_sample_from_outside_is_asked_for_once_a_moment(monkeypatch):
    asked, now = [], [1_000_000_000]
    monkeypatch.setattr("sher3_runtime.composed.outside.monotonic_ns", lambda: now[0])
    outside = Outside(lambda: asked.append(1) or [len(asked)], 20_000_000)
    outside.queues += (deque(), deque())
    for _ in range(3):
        outside.look()
    assert outside.queues == [deque([1]), deque([1])]
    now[0] += 20_000_000
    outside.look()
    assert outside.queues == [deque([1, 2]), deque([1, 2])]


def test_what_waits_for_a_node_at_work_is_handed_over_in_the_order_of_the_table_and_bounded():
    """Keep last: of more samples than the depth the newest remain, as in a queue of the middleware."""
    turn, got = Turn(), []
    ranks = {name: rank for rank, name in enumerate(TOPICS)}
    force = turn.inlet(ranks["force/measured_cf"], lambda s: got.append(("force", s)), 10)
    twist = turn.inlet(ranks["servo_cv"], lambda s: got.append(("twist", s)), 2)
    force(1)
    for number in range(4):
        twist(number)
    assert not got
    turn.begin()
    assert got == [("twist", 2), ("twist", 3), ("force", 1)]


@pytest.mark.parametrize("travel", [0.1, 1.0, 1 / 3, math.pi * 1e-12, math.inf])
def test_an_object_has_the_numbers_that_come_over_the_wire(travel):
    """A Joy carries 32-bit floats: the law must compute with the same travel in every layout."""
    sample, wire = JoySample(5, (travel,), (1,)), codec(TOPICS["pedal/measured"].type, "")
    assert as_sent(TOPICS["pedal/measured"].type)(sample) == wire.decode(wire.encode(sample))
    assert as_sent(TOPICS["measured_js"].type) is None


@pytest.mark.flaky(reruns=2)
def test_a_node_that_waits_for_its_device_does_not_hold_up_the_others():
    """One waits 80 ms of each 100 ms for a device that never answers; the other one ticks every 10 ms nevertheless.

    Every wait is judged by the ticks that fall into it, which a busy computer makes fewer, but not none.
    """
    context = Context()
    context.init(domain_id=own_domain())
    use_clock(context, Clock(10_000_000))
    silent, other_end = os.pipe()
    ticks, waits = [], []
    with Composition():
        device, loop = (Node(name, context=context, **NODE_OPTIONS) for name in ("device", "loop"))
        hears = []
        say = advertise(loop, "servo_cv")

        def wait(stamp):
            begin = time.monotonic()
            assert wait_readable((silent,), 0.08) == []
            waits.append((begin, time.monotonic()))

        def tick(stamp):
            ticks.append(time.monotonic())
            say(TwistSample(stamp, ZERO))

        subscribe(device, "servo_cv", lambda s: hears.append(s.stamp))
        on_tick(device, wait, every=10)
        on_tick(loop, tick, phase=0.001)
    spin([device, loop], stop=lambda: len(waits) >= 8, diagnostics=False)
    context.try_shutdown()
    os.close(silent), os.close(other_end)
    assert min(end - begin for begin, end in waits) > 0.079
    within = [sum(begin < at < end for at in ticks) for begin, end in waits]
    behind = [sum(begin + 0.08 < at < end for at in ticks) for begin, end in waits]
    # Held up by a wait it would not tick in it at all; kept from going on, the device would see one tick after another.
    assert min(within) >= 1 and sum(within) >= 4 * len(waits) and max(behind) <= 3
    # What came while the device was waited for was handed over afterwards, in order; none was lost.
    assert hears == sorted(hears) and len(hears) >= len(ticks) - 10


@pytest.mark.parametrize("shortest", [10, 25, 50])
def test_slow_callbacks_of_one_process_come_in_different_periods(shortest):
    """Reports of a second that all came in one period would take longer than the period, and a cycle would be lost."""
    together, clock = Composition(), SteppedClock(1_000_000)
    ticks = []
    for every in (2 * shortest, 20 * shortest, *(shortest,) * 8):
        ticks.append(Tick(print, 0, every, clock, Statistics(), None, together.offset(every)))
        ticks[-1].schedule()
        assert 0 < ticks[-1].due_ns - clock.now() <= 1_000_000 * every
    assert len({tick.due_ns % (1_000_000 * shortest) for tick in ticks}) == 10


@pytest.mark.parametrize(("limit", "first", "again"), [(0.002, 0.0, 0.0014), (0.05, 0.048, 0.048)])
def test_a_device_that_answered_last_time_is_waited_for_in_place(limit, first, again):
    """Time [s] left to the others: less of the first wait than of the next, when the device is known to be silent."""
    left, (device, other_end) = [], os.pipe()

    @contextmanager
    def others():
        begin = time.monotonic()
        yield
        left.append(time.monotonic() - begin)

    def wait():
        left[:] = [0.0]
        found = wait_readable((device,), limit)
        return bool(found), left[-1] >= 0.9 * again

    let_others_go_on(others)
    try:
        silent = [wait(), wait()]
        os.write(other_end, b"x")
        answered = wait()
        os.read(device, 1)
        after = wait()
    finally:
        let_others_go_on(None)
        os.close(device), os.close(other_end)
    assert silent == [(False, first > 0.0), (False, True)]
    assert answered == (True, False) and after == (False, first > 0.0)


def test_a_callback_that_raises_in_a_stand_in_ends_the_process():
    context = Context()
    context.init(domain_id=own_domain())
    use_clock(context, Clock(10_000_000))
    silent, other_end = os.pipe()
    with Composition():
        device, loop = (Node(name, context=context, **NODE_OPTIONS) for name in ("device", "loop"))
        waits = []

        def wait(stamp):
            waits.append(True)
            wait_readable((silent,), 0.5)

        def tick(stamp):
            if waits:
                raise ValueError("the law")

        on_tick(device, wait, every=100)
        on_tick(loop, tick, phase=0.005)
    with pytest.raises(ValueError, match="the law"):
        spin([device, loop], diagnostics=False)
    context.try_shutdown()
    os.close(silent), os.close(other_end)
