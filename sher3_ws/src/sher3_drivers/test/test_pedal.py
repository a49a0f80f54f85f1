"""Pedal back-ends: the kernel's joystick events, the datagram of the mock, and what is missing or lost."""

import math
import os

import pytest
from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import PedalState, check_pedal
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.pedal.joystick import JS_EVENT, JoystickPedal
from sher3_drivers.pedal.local import LocalPedal, PedalSender


@pytest.fixture
def joystick(tmp_path):
    """A pedal on a pipe, and a function that sends it events (value, type, number)."""
    path = tmp_path / "js0"
    os.mkfifo(path)
    pedal = JoystickPedal(str(path))
    writer = os.open(path, os.O_WRONLY)

    def send(*events):
        os.write(writer, b"".join(JS_EVENT.pack(0, *event) for event in events))

    yield pedal, send, lambda: os.close(writer)
    pedal.close()
    pedal.close()


def test_the_state_is_told_at_opening_and_kept(joystick):
    pedal, send, _ = joystick
    assert pedal.read() is None
    send((-32767, 0x82, 0), (0, 0x81, 0))
    assert pedal.read() == PedalState(0.0, False)
    send((0, 2, 0), (32767, 2, 1), (1, 1, 3))
    assert pedal.read() == PedalState(0.5, False)
    assert pedal.read() == PedalState(0.5, False)
    send((32767, 2, 0), (1, 1, 0))
    assert pedal.read() == PedalState(1.0, True)
    send((-32768, 2, 0), (0, 1, 0))
    assert pedal.read() == PedalState(0.0, False)


def test_an_unplugged_pedal_is_an_error(joystick):
    pedal, send, unplug = joystick
    send((0, 2, 0))
    pedal.read()
    unplug()
    with pytest.raises(DeviceMissing, match="unplugged"):
        pedal.read()


def test_a_missing_pedal_is_an_error_at_once():
    with pytest.raises(DeviceMissing, match="/dev/input/js9999"):
        JoystickPedal("/dev/input/js9999")


def test_the_local_pedal_follows_its_sender_and_notices_its_silence(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    now = [1_000_000_000]
    pedal, sender = LocalPedal(clock=lambda: now[0]), PedalSender()
    assert pedal.read() is None
    assert sender.send(PedalState(0.25, False)) and sender.send(PedalState(0.75, True))
    assert pedal.read() == PedalState(0.75, True)
    now[0] += 18_000_000
    assert pedal.read() == PedalState(0.75, True)
    now[0] += 4_000_000
    with pytest.raises(DeviceMissing, match="silent"):
        pedal.read()
    sender.send(PedalState(0.0, False))
    assert pedal.read() == PedalState(0.0, False)
    pedal.close()
    assert not sender.send(PedalState(0.0, False))


def test_the_in_process_pedal_can_be_lost():
    pedal = InProcessPedal()
    assert pedal.read() is None
    pedal.put(PedalState(1.0, False))
    assert pedal.read() == PedalState(1.0, False)
    pedal.put(None)
    with pytest.raises(DeviceMissing):
        pedal.read()


@pytest.mark.parametrize("travel", [math.nan, math.inf, -0.01, 1.01])
def test_no_pedal_has_such_a_travel(travel):
    assert not check_pedal(PedalState(travel, False))
