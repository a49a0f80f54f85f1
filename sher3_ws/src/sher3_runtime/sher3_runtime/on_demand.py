"""Publishers of streams that the control loop does not need: nothing is made or sent while nobody listens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from sher3_runtime.ports import Publish, advertise, ports

COUNT_EVERY = 50
"""Samples after which a publisher on demand asks again whether there is a subscriber."""


class OnDemand:
    """`publish(sample)` of a stream that the control loop does not need; ask `wanted()` before making the sample.

    A new subscriber is noticed after at most `COUNT_EVERY` samples, in stepped time at once.
    """

    __slots__ = ("_ask_in", "_count", "_publish", "_stepped", "_wanted")

    def __init__(self, publish: Publish, count: Callable[[], int], stepped: bool) -> None:
        self._publish, self._count, self._stepped = publish, count, stepped
        self._ask_in, self._wanted = 0, True

    def wanted(self) -> bool:
        """Return whether there is a subscriber; to be asked once for each sample."""
        if self._stepped:
            return self._count() > 0
        if self._ask_in == 0:
            self._ask_in, self._wanted = COUNT_EVERY, self._count() > 0
        self._ask_in -= 1
        return self._wanted

    def __call__(self, sample: Any) -> None:
        """Publish a sample."""
        self._publish(sample)


def advertise_on_demand(node: Node, name: str) -> OnDemand:
    """Return `publish(sample)` of a topic of the table, with `publish.wanted()`.

    Raises:
        UnknownTopic: the name is not in the table.
    """
    publish, port = advertise(node, name), ports(node)
    count: Callable[[], int] = port.listeners(name)
    if (composition := port.composition) is not None:
        offers, outside, beside = composition.offers(name), count, composition.beside(name)

        def count() -> int:
            return len(offers) + outside() + beside()

    return OnDemand(publish, count, port.clock.stepped)
