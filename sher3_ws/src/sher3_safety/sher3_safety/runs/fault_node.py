"""One request for a fault into a running graph, with the plant's answer."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import rclpy
from rclpy.executors import Executor
from rclpy.node import Node
from sher3_bringup.errors import StartError
from sher3_common import Sher3Error
from sher3_common.samples import DiagnosticSample, TextSample
from sher3_description import TOPICS
from sher3_faults.requests import FaultRequest
from sher3_runtime import environment
from sher3_runtime.execution.spinning import make_executor
from sher3_runtime.ports import NODE_OPTIONS, advertise, ports, subscribe

PATIENCE, TURN = 5.0, 0.02
"""Longest wait on an idle computer for the robot, and for its answer; and for one turn of the executor [s]."""
AGAIN = 1.0
"""Seconds after which a request without an answer is sent again: the plant may take it before it has found whom to
answer. Taken twice it is the same fault, which begins anew."""
ANSWER = "plant: faults"


class NotInjected(Sher3Error):
    """The running robot has refused the fault."""

    exit_code = 2


def inject(request: FaultRequest, domain: int) -> str:
    """Send a request on `mock/fault` and return what the plant says.

    Raises:
        StartError: no plant answers: no robot runs on this domain, or it runs on hardware, which takes no faults.
        NotInjected: the plant refuses.
    """
    environment.apply(domain)
    rclpy.init()
    node = Node("fault", **NODE_OPTIONS)
    try:
        heard: list[DiagnosticSample] = []
        subscribe(node, "diagnostics", lambda sample: heard.append(sample) if sample.name == ANSWER else None)
        publish = advertise(node, "mock/fault")
        executor = make_executor([node])
        wait_for(executor, lambda: _met(node), f"no robot on mocks runs on domain {domain}; hardware takes no faults")
        ask = repeated(partial(publish, TextSample(request.to_json())), lambda: bool(heard))
        wait_for(executor, ask, "the plant does not answer")
        executor.shutdown()
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    if "refused" in heard[0].message:
        raise NotInjected(heard[0].message)
    return heard[0].message


def repeated(send: Callable[[], None], answered: Callable[[], bool]) -> Callable[[], bool]:
    """Return a condition that sends at once, and again every `AGAIN` seconds, until it is answered."""
    due = -math.inf

    def asked() -> bool:
        nonlocal due
        if answered():
            return True
        if time.monotonic() >= due:
            due = time.monotonic() + AGAIN
            send()
        return False

    return asked


def _met(node: Node) -> bool:
    """Whether the plant is there and both ways to it are open."""
    listeners = node.get_subscriptions_info_by_topic(TOPICS["mock/fault"].full_name)
    speakers = node.get_publishers_info_by_topic(TOPICS["diagnostics"].full_name)
    out: Any = ports(node).publishers["mock/fault"]
    back: Any = ports(node).subscriptions["diagnostics"]
    return (
        any(end.node_name == "plant" for end in listeners)
        and out.get_subscription_count() >= len(listeners)
        and back.handle.get_publisher_count() >= len(speakers)
    )


def wait_for(executor: Executor, condition: Callable[[], bool], otherwise: str) -> None:
    """Wait until a condition holds: a busy computer, whose turns last longer, is given as many turns.

    Raises:
        StartError: neither `PATIENCE` nor as many turns as an idle computer makes in it were enough.
    """
    deadline, turns = time.monotonic() + PATIENCE, 0
    while not condition():
        if time.monotonic() > deadline and turns * TURN > PATIENCE:
            raise StartError(otherwise, limit=f"{PATIENCE:g} s", remedy="start `sher3 up`, or name its --domain")
        executor.spin_once(TURN)
        turns += 1
