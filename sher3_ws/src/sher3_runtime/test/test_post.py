"""Samples of a graph without the middleware: the same as with it, in queues of the same depth."""

import gc
import weakref

import pytest
from rclpy.node import Node
from sher3_common.samples import JoySample, TextSample, WrenchSample
from sher3_runtime import NODE_OPTIONS, Graph, advertise, latest, on_tick, subscribe, subscribe_raw
from sher3_runtime.ports import ports
from sher3_runtime.post import Post


def test_a_box_keeps_the_newest():
    """Two of three samples stay where two have room; a box that is held gets nothing until it goes on."""
    post, got = Post(), []
    box, send = post.box("a", 2, got.append), post.sender("a", latched=False)
    post.hold([box], held=True)
    for data in (b"1", b"2", b"3"):
        send(data)
    assert not post.deliver() and got == []
    post.hold([box], held=False)
    assert post.deliver() and got == [b"2", b"3"]
    assert not post.deliver()


def test_boxes_are_served_in_the_order_of_their_subscriptions():
    """Whichever was sent first; what a callback sends is delivered too, and who looks by itself is not called."""
    post, got = Post(), []
    post.box("a", 10, lambda data: (got.append(("a", data)), send_b(b"answer")))
    post.box("b", 10, lambda data: got.append(("b", data)))
    asks = post.box("b", 1, None)
    send_a, send_b = post.sender("a", latched=False), post.sender("b", latched=False)
    send_b(b"first")
    send_a(b"second")
    post.deliver()
    assert got == [("a", b"second"), ("b", b"first"), ("b", b"answer")]
    assert asks.take() == b"answer" and asks.take() is None
    assert post.listeners("b")() == 2 and post.listeners("c")() == 0


def test_a_latched_topic_keeps_its_last_sample():
    """Who comes later gets it, and who has left gets nothing."""
    post, got = Post(), []
    send = post.sender("state", latched=True)
    send(b"1")
    send(b"2")
    box = post.box("state", 1, got.append)
    post.deliver()
    post.leave("state", box)
    send(b"3")
    post.deliver()
    assert got == [b"2"]


class Source(Node):
    """Publishes the wrench (k, 0, ...) and the pedal k at tick k, and its state once."""

    def __init__(self, **options):
        super().__init__("source", **{**NODE_OPTIONS, **options})
        self.publish, self.press, self.ticks = advertise(self, "force/measured_cf"), advertise(self, "mock/pedal"), 0
        advertise(self, "operating_state")(TextSample("ENABLED"))
        on_tick(self, self.tick)

    def tick(self, stamp):
        self.publish(WrenchSample(stamp, (float(self.ticks), 0.0, 0.0, 0.0, 0.0, 0.0)))
        self.press(JoySample(stamp, (float(self.ticks),), (0,)))
        self.ticks += 1


class Listener(Node):
    """Hears the wrench, looks for the pedal by itself, and hears the state."""

    def __init__(self, **options):
        super().__init__("listener", **{**NODE_OPTIONS, **options})
        self.heard, self.states = [], []
        subscribe(self, "force/measured_cf", lambda sample: self.heard.append(sample.wrench[0]))
        self.take = latest(self, "mock/pedal")
        subscribe(self, "operating_state", lambda sample: self.states.append(sample.text))


class Ears(Node):
    """Hears the wrench as bytes."""

    def __init__(self, **options):
        super().__init__("ears", **{**NODE_OPTIONS, **options})
        self.raw = []
        subscribe_raw(self, "force/measured_cf", self.raw.append)


@pytest.mark.graph
@pytest.mark.parametrize("middleware", [False, True])
def test_a_graph_hears_the_same_either_way(middleware):
    """Samples, bytes, a latched state, the newest sample; a paused node finds as many as its queue holds."""
    with Graph(middleware=middleware) as graph:
        graph.add(Source)
        listener, ears = graph.add(Listener), graph.add(Ears)
        graph.step(5)
        assert listener.heard == [0.0, 1.0, 2.0, 3.0, 4.0]
        assert len(ears.raw) == 5 and listener.take().axes == (4.0,)
        graph.until(lambda: listener.states)
        assert listener.states == ["ENABLED"]
        graph.pause(listener)
        graph.step(20)
        assert len(listener.heard) == 5
        depth = 10
        graph.resume(listener)
        assert listener.heard[5:] == [float(k) for k in range(25 - depth, 25)]
        assert ports(listener).subscriptions["force/measured_cf"].handle.get_publisher_count() == 1


def test_a_sample_is_made_once_for_all_who_hear_it():
    """The same bytes are decoded once, whoever asks; bytes that are none are refused each time."""
    post, asked = Post(), []

    def decode(data):
        asked.append(data)
        return TextSample(data.decode())

    one, other = post.decoder("a", decode), post.decoder("a", decode)
    assert one(b"1") is other(b"1") and asked == [b"1"]
    for _ in range(2):
        with pytest.raises(UnicodeDecodeError):
            one(b"\xff")
    assert asked == [b"1", b"\xff", b"\xff"]


def test_a_graph_that_has_ended_leaves_no_node_behind():
    """Each robot built in a process left 3 MB: its post held the nodes, and they the context it was found by."""
    with Graph(middleware=False) as graph:
        source = weakref.ref(graph.add(Source))
        graph.step(3)
    del graph
    gc.collect()
    assert source() is None
