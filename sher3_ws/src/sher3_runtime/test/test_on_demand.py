"""Streams that nobody listens to are not sent."""

from __future__ import annotations

from sher3_runtime.on_demand import COUNT_EVERY, OnDemand


def test_nothing_is_wanted_while_nobody_listens_and_a_listener_is_noticed():
    listeners = [0]
    sent: list[int] = []
    publish = OnDemand(sent.append, lambda: listeners[0], stepped=False)
    assert not any(publish.wanted() for _ in range(COUNT_EVERY))
    listeners[0] = 1
    assert publish.wanted()
    publish(7)
    assert sent == [7]
    listeners[0] = 0
    assert sum(publish.wanted() for _ in range(2 * COUNT_EVERY)) == COUNT_EVERY - 1


def test_in_stepped_time_a_listener_is_noticed_at_once():
    listeners = [0]
    publish = OnDemand(lambda _: None, lambda: listeners[0], stepped=True)
    assert not publish.wanted()
    listeners[0] = 1
    assert publish.wanted()
    listeners[0] = 0
    assert not publish.wanted()
