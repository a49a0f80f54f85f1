"""Nodes in stepped time: order, stamps, services, losses and failures."""

from itertools import pairwise

import pytest
from rclpy.node import Node
from sher3_common.samples import JoySample, TextSample, WrenchSample
from sher3_description import TOPICS
from sher3_runtime import (
    NODE_OPTIONS,
    Graph,
    advertise,
    advertise_raw,
    latest,
    on_tick,
    statistics_of,
    subscribe,
    subscribe_raw,
)
from sher3_runtime.codec.cdr import codec
from sher3_runtime.ports import UnknownTopic, ports, qos_profile
from std_msgs.msg import String
from std_srvs.srv import Trigger

pytestmark = pytest.mark.graph


class Source(Node):
    """Publishes the wrench (k, 0, ...) at tick k."""

    def __init__(self, **options):
        super().__init__("source", **{**NODE_OPTIONS, **options})
        self.publish = advertise(self, "force/measured_cf")
        self.ticks = 0
        on_tick(self, self.tick, phase=0.0001)

    def tick(self, stamp):
        self.publish(WrenchSample(stamp, (float(self.ticks), 0.0, 0.0, 0.0, 0.0, 0.0)))
        self.ticks += 1


class Echo(Node):
    """Answers each wrench with a pedal sample of the same stamp and offers a service."""

    def __init__(self, **options):
        super().__init__("echo", **{**NODE_OPTIONS, **options})
        self.publish = advertise(self, "mock/pedal")
        subscribe(self, "force/measured_cf", self.on_wrench)
        self.create_service(Trigger, "tare", self.on_tare)

    def on_wrench(self, sample):
        if sample.wrench[0] == 13.0:
            raise RuntimeError("thirteen")
        self.publish(JoySample(sample.stamp, (sample.wrench[0],), (0,)))

    def on_tare(self, _request, response):
        response.success, response.message = True, "tared"
        return response


def test_a_step_is_complete():
    """After a step every consequence of the tick has happened, once, with the stamp of the tick."""
    with Graph() as graph:
        graph.add(Source)
        graph.add(Echo)
        probe = graph.probe("force/measured_cf", "mock/pedal")
        last = graph.step(10)
        pedal = probe.samples["mock/pedal"]
        assert [s.axes for s in pedal] == [(float(k),) for k in range(10)]
        assert [s.stamp for s in pedal] == [s.stamp for s in probe.samples["force/measured_cf"]]
        assert pedal[-1].stamp == last
        assert {b.stamp - a.stamp for a, b in pairwise(pedal)} == {2_000_000}


def test_callback_exceptions_reach_the_caller():
    """Nothing is swallowed."""
    with Graph() as graph:
        graph.add(Source)
        graph.add(Echo)
        with pytest.raises(RuntimeError, match="thirteen"):
            graph.step(20)


def test_services_are_ordinary():
    """An rclpy service and client work in the same wait set."""
    with Graph() as graph:
        graph.add(Echo)
        probe = graph.probe()
        client = probe.create_client(Trigger, "tare")
        graph.step()
        assert client.wait_for_service(5.0)
        future = client.call_async(Trigger.Request())
        graph.until(future.done)
        assert future.result().message == "tared"


def test_garbage_is_counted_and_dropped():
    """Bytes that are no message never reach the callback."""
    with Graph() as graph:
        echo = graph.add(Echo)
        probe = graph.probe("mock/pedal", sends=("force/measured_cf",))
        graph.step()
        publisher = probe.__dict__["_sher3_ports"].publishers["force/measured_cf"]
        publisher.publish(b"\x00\x01\x00\x00garbage")
        probe.__dict__["_sher3_ports"].sent["force/measured_cf"] += 1
        graph.settle()
        probe.send("force/measured_cf", WrenchSample(7, (1.0,) * 6))
        graph.settle()
        assert statistics_of(echo).garbage == {"force/measured_cf": 1}
        assert [s.stamp for s in probe.samples["mock/pedal"]] == [7]


def test_gaps_in_a_stream_are_counted():
    """A stamp that skips two ticks is two lost samples."""
    with Graph() as graph:
        echo = graph.add(Echo)
        probe = graph.probe(sends=("force/measured_cf",))
        graph.step()
        for k in (1, 2, 5, 6):
            probe.send("force/measured_cf", WrenchSample(k * 2_000_000, (0.0,) * 6))
            graph.settle()
        assert statistics_of(echo).dropped == {"force/measured_cf": 2}


def test_latched_topics_reach_a_late_subscriber():
    """The operating state is there for who comes later."""
    with Graph() as graph:
        early = graph.probe(sends=("operating_state",))
        graph.step()
        early.send("operating_state", TextSample("ENABLED"))
        late = graph.probe("operating_state")
        graph.step()
        assert late.samples["operating_state"] == [TextSample("ENABLED")]


def test_settled_means_that_latched_topics_are_up_to_date():
    """A reader keeps one sample: of several that are sent at once it has the last, whoever came when."""
    with Graph() as graph:
        sender = graph.probe(sends=("operating_state", "motion/status"))
        readers = [graph.probe("operating_state", "motion/status") for _ in range(4)]
        graph.step()
        for k in range(30):
            for text in (f"a{k}", f"b{k}"):
                sender.send("operating_state", TextSample(text))
            sender.send("motion/status", TextSample(f"m{k}"))
            graph.settle()
            assert {reader.samples["operating_state"][-1].text for reader in readers} == {f"b{k}"}
            assert {reader.samples["motion/status"][-1].text for reader in readers} == {f"m{k}"}


def test_a_strangers_sample_on_a_latched_topic_holds_nobody_up():
    """It may take the place of the last one in the reader's queue, which then never comes."""
    with Graph() as graph:
        sender, reader = graph.probe(sends=("operating_state",)), graph.probe("operating_state")
        stranger = sender.create_publisher(String, "operating_state", qos_profile(TOPICS["operating_state"].qos))
        for k in range(20):
            graph.step()
            sender.send("operating_state", TextSample(f"a{k}"))
            stranger.publish(String(data=f"z{k}"))
            graph.settle()
        assert reader.samples["operating_state"]


def test_entities_may_come_and_go():
    """The wait set follows subscriptions that are made and destroyed while it spins."""
    with Graph() as graph:
        source = graph.add(Source)
        graph.step(2)
        late = graph.probe("force/measured_cf")
        graph.step(3)  # samples sent before it subscribed are none of its business
        assert len(late.samples["force/measured_cf"]) == 3
        timer = source.create_timer(1000.0, lambda: None)
        graph.step()
        source.destroy_timer(timer)
        graph.step()
        assert len(late.samples["force/measured_cf"]) == 5


def test_raw_ports_pass_bytes_through():
    """What a recorder sees is what a replay publishes."""
    with Graph() as graph:
        source, sink, seen = graph.add(Source), graph.probe("mock/contact_wrench"), []
        subscribe_raw(sink, "force/measured_cf", seen.append)
        send = advertise_raw(source, "mock/contact_wrench")
        graph.step(3)
        assert len(seen) == 3
        with pytest.raises(UnknownTopic):
            advertise_raw(source, "nothing")
        send(codec("geometry_msgs/msg/WrenchStamped", "b").encode(WrenchSample(5, (2.0,) * 6)))
        graph.settle()
        assert sink.samples["mock/contact_wrench"] == [WrenchSample(5, (2.0,) * 6)]


def test_latest_is_the_newest_and_wakes_nobody():
    with Graph() as graph:
        graph.add(Source)
        probe = graph.probe()
        take = latest(probe, "force/measured_cf")
        graph.step(5)
        graph.until(lambda: (sample := take()) is not None and sample.wrench[0] == 4.0)
        assert take() is None


def test_a_tick_that_is_done_is_skipped():
    """What looks after late samples costs nothing when they are in time."""
    with Graph() as graph:
        probe, calls = graph.probe(), []
        tick = on_tick(probe, calls.append, phase=0.001)
        stamp = graph.step()
        due = tick.due_ns
        tick.done(stamp)
        assert tick.due_ns == due
        tick.done(due - tick.phase_ns)
        assert tick.due_ns == due + 2_000_000
        assert calls == [stamp]


def test_the_period_counts_ticks_however_they_were_done():
    """A node whose input does the work of most ticks has the period of its work, not that of its rare alarms."""
    with Graph() as graph:
        probe = graph.probe()
        tick = on_tick(probe, lambda _: None)
        for _ in range(6):
            stamp = graph.step()
            tick.done(stamp + 2_000_000)
        assert ports(probe).statistics.period.maximum == 2_000_000


def test_slow_ticks_and_names():
    """`every` counts in periods of the grid; a name outside the table is refused."""
    with Graph() as graph:
        probe = graph.probe()
        stamps = []
        on_tick(probe, stamps.append, every=5)
        graph.step(20)
        assert len(stamps) == 4 and all(stamp % 10_000_000 == 0 for stamp in stamps)
        with pytest.raises(UnknownTopic, match=r"measured_jz.*servo_jv"):
            subscribe(probe, "measured_jz", print)
