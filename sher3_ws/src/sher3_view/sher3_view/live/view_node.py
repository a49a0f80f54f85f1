"""The live view as a node: it listens. To mocks it also hands on what is asked for on its page."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node
from sher3_common.samples import JoySample, TextSample, WrenchSample
from sher3_description import TOPICS as TABLE
from sher3_faults.requests import FaultRequest
from sher3_runtime.beside import beside
from sher3_runtime.ports import NODE_OPTIONS, advertise, clock_of, latest

from sher3_view.live.hand import Hand
from sher3_view.live.mock_panel import Effect
from sher3_view.live.page import LivePage
from sher3_view.live.snapshot import TOPICS, Snapshot

RATE = 30.0
"""Moments per second. Between them no sample wakes this process, so the graph does not feel that it is there."""
LOOK_AROUND = 1.0
"""Seconds between two looks for a plant with mocks."""


class ViewNode(Node):
    """Holds the newest sample of each topic.

    Attributes:
        snapshot: what is known of the robot.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("view", **{**NODE_OPTIONS, **options})
        self.snapshot = Snapshot.empty()
        self._newest = {topic: latest(self, topic) for topic in TOPICS}
        self._publish: dict[str, Callable[[Any], None]] = {}

    def look(self) -> None:
        """Take what has come."""
        self.snapshot.take(self._newest)

    def mocks(self, topic: str = "mock/fault") -> bool:
        """Whether a plant with mocks listens to requests, by default for faults; hardware has none."""
        ends = self.get_subscriptions_info_by_topic(TABLE[topic].full_name)
        return any(end.node_name == "plant" for end in ends)

    def ask(self, request: FaultRequest) -> None:
        """Ask the plant for a fault; nothing happens where there is no plant."""
        if self.mocks():
            self._send("mock/fault", TextSample(request.to_json()))

    def exchange(self, effects: Sequence[Effect]) -> None:
        """Ask the plant for these effects instead of those it has; nothing happens where no plant takes them."""
        if self.mocks("mock/effects"):
            entries = [{"effect": name, "actuator": place} for name, place in effects]
            self._send("mock/effects", TextSample(json.dumps(entries)))

    def act(self, hand: Hand) -> None:
        """Let the mocks feel a hand that somebody has used; whoever calls makes sure that there are mocks."""
        if not hand.touched:
            return
        if command := hand.taken():
            self._send("command/state_command", TextSample(command))
        stamp = clock_of(self).now()
        self._send("mock/pedal", JoySample(stamp, (float(hand.pedal),), (0,)))
        self._send("mock/contact_wrench", WrenchSample(stamp, (*hand.force, 0.0, 0.0, 0.0)))

    def _send(self, topic: str, sample: Any) -> None:
        if topic not in self._publish:
            # Not earlier: a view on which nothing is asked for is no publisher.
            self._publish[topic] = advertise(self, topic)
            time.sleep(LOOK_AROUND / 2)
        self._publish[topic](sample)


def run(page: LivePage, domain: int, seconds: float | None) -> None:
    """Show the robot of a domain until a signal, or for so many seconds."""
    with beside(domain, 1.0 / RATE, seconds) as moments:
        try:
            node = ViewNode()
            looked = time.monotonic()
            mocks = exchange = False
            for now in moments:
                if now - looked >= LOOK_AROUND:
                    looked, mocks, exchange = now, node.mocks(), node.mocks("mock/effects")
                node.look()
                page.mocks.show(mocks, exchange)
                page.show(node.snapshot, clock_of(node).now())
                for request in page.mocks.faults():
                    node.ask(request)
                for effects in page.mocks.exchanges():
                    node.exchange(effects)
                if mocks:
                    node.act(page.mocks.hand)
            node.destroy_node()
        finally:
            page.close()
