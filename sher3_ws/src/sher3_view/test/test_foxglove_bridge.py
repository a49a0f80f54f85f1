"""The bridge speaks the protocol of Foxglove: a client is told the channels, and gets what was sent, late or not."""

import json
import socket
import struct

import pytest
from sher3_bags.recording.beside import Beside
from sher3_description import load_robot
from sher3_view.errors import ViewError
from sher3_view.live import LOOPBACK
from sher3_view.live.foxglove_bridge import FoxgloveBridge
from websockets.sync.client import connect

MESSAGE_DATA = 1
"""First byte of a binary frame with a message: subscription (u32), time (u64), then the message."""


@pytest.fixture
def port():
    with socket.socket() as free:
        free.bind((LOOPBACK, 0))
        return free.getsockname()[1]


@pytest.fixture
def bridge(port):
    made = FoxgloveBridge(port)
    yield made
    made.close()


def heard(client, wanted):
    """The first thing a client hears that is `wanted`."""
    for _ in range(50):
        found = wanted(client.recv(timeout=30.0))
        if found:
            return found
    raise AssertionError("not heard")


def channels(frame):
    message = json.loads(frame) if isinstance(frame, str) else {}
    return {c["topic"]: c for c in message["channels"]} if message.get("op") == "advertise" else None


def told(bridge, client):
    """The first message that reaches a client; the bridge repeats, since nobody says when it took the subscription."""
    for stamp in range(2_000_000_000, 100_000_000_000, 2_000_000_000):
        bridge.repeat(stamp)
        try:
            frame = client.recv(timeout=0.5)
        except TimeoutError:
            continue
        if isinstance(frame, bytes) and frame[0] == MESSAGE_DATA:
            return frame
    raise AssertionError("no message")


def test_a_client_that_comes_late_gets_the_description(bridge, port):
    robot = load_robot()
    fixed = Beside(robot).fixed(5)
    for made in fixed:
        bridge.send(made.topic, made.type, made.data, 5, latched=True)
    with connect(f"ws://{LOOPBACK}:{port}", subprotocols=["foxglove.sdk.v1"]) as client:
        channel = heard(client, channels)["/robot_description"]
        assert (channel["encoding"], channel["schemaName"]) == ("cdr", "std_msgs/msg/String")
        assert channel["schema"] == "string data\n"
        client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel["id"]}]}))
        frame = told(bridge, client)
    subscription, _ = struct.unpack_from("<IQ", frame, 1)
    assert subscription == 7
    assert frame[13:] == fixed[0].data and b"<robot" in frame


def test_a_port_that_is_taken_is_named(bridge, port):
    with pytest.raises(ViewError, match=f"value {port}.*--port"):
        FoxgloveBridge(port)
