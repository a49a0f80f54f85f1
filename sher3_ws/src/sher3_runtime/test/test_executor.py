"""The executor in real time: what it waits for, what it looks at now and then, and in which order it delivers."""

import time

import pytest
from rclpy.context import Context
from rclpy.node import Node
from sher3_common.samples import JoySample, TextSample, TwistSample, WrenchSample
from sher3_runtime import NODE_OPTIONS, advertise, clock_of, on_tick, subscribe
from sher3_runtime.composed import newest
from sher3_runtime.composed.ring import Ring, share
from sher3_runtime.domains import own_domain
from sher3_runtime.execution.executor import QUIET_NS, RawExecutor
from sher3_runtime.ports import by_ring
from std_srvs.srv import Trigger

pytestmark = [pytest.mark.graph, pytest.mark.flaky(reruns=2)]
NAMES = ("pedal/measured", "force/measured_cf", "servo_cv")
ZERO = (0.0,) * 6


@pytest.fixture
def node():
    context = Context()
    context.init(domain_id=own_domain())
    made = Node("probe", context=context, **NODE_OPTIONS)
    yield made
    made.destroy_node()
    context.shutdown()


@pytest.fixture
def spin(node):
    """Return what runs the node until a condition holds."""
    executor = RawExecutor(context=node.context)
    executor.add_node(node)

    def until(condition, patience=5.0):
        end = time.monotonic() + patience
        while not condition() and time.monotonic() < end:
            executor.spin_once(0.01)
        return condition()

    yield until
    executor.shutdown()


def test_a_topic_that_wakes_nobody_is_delivered_in_its_order(node, spin):
    heard = []
    quiet = subscribe(node, "pedal/measured", lambda sample: heard.append(("pedal", sample.stamp)))
    subscribe(node, "force/measured_cf", lambda sample: heard.append(("force", sample.stamp)))
    press, push = advertise(node, "pedal/measured"), advertise(node, "force/measured_cf")
    press(JoySample(1, (0.0,), (0,)))
    push(WrenchSample(1, ZERO))
    assert spin(lambda: len(heard) == 2)
    quiet.wakes = False
    for stamp in range(2, 50):
        press(JoySample(stamp, (0.0,), (0,)))
        push(WrenchSample(stamp, ZERO))
        assert spin(lambda wanted=2 * stamp: len(heard) == wanted)
    assert heard == [(name, stamp) for stamp in range(1, 50) for name in ("pedal", "force")]


def test_a_topic_without_others_is_heard_though_it_wakes_nobody(node, spin):
    heard = []
    subscribe(node, "pedal/measured", heard.append).wakes = False
    press = advertise(node, "pedal/measured")
    for stamp in range(1, 20):
        press(JoySample(stamp, (0.0,), (0,)))
        assert spin(lambda wanted=stamp: len(heard) == wanted)


def test_samples_of_one_tick_are_all_heard_though_only_one_is_expected(node, spin):
    """The second one waits for the next spin."""
    heard, push = [], advertise(node, "force/measured_cf")
    subscribe(node, "force/measured_cf", heard.append)
    for _ in range(20):
        stamp = clock_of(node).now()
        heard.clear()
        push(WrenchSample(stamp, ZERO))
        push(WrenchSample(stamp, ZERO))
        assert spin(lambda: len(heard) == 2)


def test_a_look_at_everything_costs_no_wake_up_of_its_own(node):
    """A process with a tick each period wakes up for its ticks alone, and hears the rare all the same."""
    ticks, spins, states = [], 0, []
    subscribe(node, "operating_state", lambda sample: states.append(sample.text))
    state = advertise(node, "operating_state")
    on_tick(node, ticks.append)
    executor = RawExecutor(context=node.context)
    executor.add_node(node)
    end = time.monotonic() + 0.4
    while time.monotonic() < end:
        executor.spin_once(0.01)
        spins += 1
        if len(ticks) == 50 and not states:
            state(TextSample("ENABLED"))
    executor.shutdown()
    assert states == ["ENABLED"] and len(ticks) > 50
    assert spins <= len(ticks) + 10


def test_rare_topics_and_services_are_served_beside_a_stream(node, spin):
    streamed, states, calls = [], [], []
    subscribe(node, "servo_cv", streamed.append)
    subscribe(node, "operating_state", lambda sample: states.append(sample.text))
    node.create_service(Trigger, "tare", lambda _, response: calls.append(1) or response)
    client = node.create_client(Trigger, "tare")
    twist, state = advertise(node, "servo_cv"), advertise(node, "operating_state")

    def stream():
        twist(TwistSample(len(streamed) + 1, ZERO))
        return False

    spin(stream, 2.0 * QUIET_NS * 1e-9)
    state(TextSample("ENABLED"))
    assert spin(lambda: stream() or states == ["ENABLED"])
    future = client.call_async(Trigger.Request())
    assert spin(lambda: stream() or future.done())
    assert calls == [1] and len(streamed) > 10


@pytest.mark.parametrize("rings", [0, 1])
def test_an_emergency_stop_beside_a_ring_wakes_who_has_heard_nothing_for_long(node, spin, monkeypatch, rings):
    """A silent topic waits for the next look at everything, which never comes here; what must be heard does not."""
    monkeypatch.setattr("sher3_runtime.execution.executor.QUIET_NS", 0)
    monkeypatch.setattr("sher3_runtime.execution.executor.LOOK_NS", 1 << 60)
    share([Ring(1 << 18) for _ in range(rings)])
    newest.newest_of_rings.cache_clear()
    try:
        heard = []
        pedal = subscribe(node, "pedal/measured", heard.append)
        by_ring(node, "pedal/measured", 32)
    finally:
        share(())
        newest.newest_of_rings.cache_clear()
    assert pedal.urgent is bool(rings)
    press = advertise(node, "pedal/measured")
    spin(lambda: False, 0.1)
    press(JoySample(1, (0.0,), (1,)))
    assert spin(lambda: bool(heard), 5.0 if rings else 0.2) is bool(rings)
