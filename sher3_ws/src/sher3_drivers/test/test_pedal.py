"""Pedal back-ends: reports of the raw HID device, the datagram of the mock, and what is missing or lost."""

import math
import os

import pytest
from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import PedalState, check_pedal, wired
from sher3_drivers.pedal.hid import MADE, REPORT, REST, STOP, HidPedal
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.pedal.local import LocalPedal, PedalSender


@pytest.fixture
def hid(tmp_path):
    """A pedal on a pipe, a function that sends it reports (travel, switches, counter), the clock, and its plug."""
    path, now = tmp_path / "hidraw0", [1_000_000_000]
    os.mkfifo(path)
    pedal = HidPedal(str(path), clock=lambda: now[0])
    writer = os.open(path, os.O_WRONLY)

    def send(*reports):
        for report in reports:
            os.write(writer, REPORT.pack(*report))

    yield pedal, send, now, lambda: os.close(writer)
    pedal.close()
    pedal.close()


def test_a_report_holds_the_whole_state_and_the_newest_counts(hid):
    pedal, send, _, _ = hid
    assert pedal.read() is None
    send((0, REST, 1), (65535, MADE, 2))
    assert pedal.read() == PedalState(1.0, False, True, False)
    send((0, REST | STOP, 3))
    assert pedal.read() == PedalState(0.0, True, False, True)


def test_a_pedal_that_says_nothing_new_has_fallen_silent(hid):
    """Reports that repeat their counter are those of a controller that hangs."""
    pedal, send, now, _ = hid
    send((65535, MADE, 7))
    assert pedal.read().travel == 1.0
    for _ in range(2):
        now[0] += 15_000_000
        send((65535, MADE, 7))
        if now[0] < 1_020_000_000:
            assert pedal.read().travel == 1.0
    with pytest.raises(DeviceMissing, match="fell silent"):
        pedal.read()
    send((0, REST, 8))
    assert pedal.read().travel == 0.0


def test_an_unplugged_pedal_is_an_error(hid):
    pedal, send, _, unplug = hid
    send((0, REST, 1))
    pedal.read()
    unplug()
    with pytest.raises(DeviceMissing, match="unplugged"):
        pedal.read()


def test_a_missing_pedal_is_an_error_at_once():
    with pytest.raises(DeviceMissing, match="/dev/hidraw9999"):
        HidPedal("/dev/hidraw9999")


def test_the_local_pedal_follows_its_sender_and_notices_its_silence(runtime_folder):
    now = [1_000_000_000]
    pedal, sender = LocalPedal(clock=lambda: now[0]), PedalSender()
    assert pedal.read() is None
    assert sender.send(PedalState(0.25, False)) and sender.send(PedalState(0.75, True))
    assert pedal.read() == wired(PedalState(0.75, True))
    now[0] += 18_000_000
    assert pedal.read() == wired(PedalState(0.75, True))
    now[0] += 4_000_000
    with pytest.raises(DeviceMissing, match="silent"):
        pedal.read()
    sender.send(PedalState(0.0, False))
    assert pedal.read() == wired(PedalState(0.0, False))
    pedal.close()
    assert not sender.send(PedalState(0.0, False))


def test_the_sender_finds_a_pedal_that_comes_later_and_one_that_comes_anew(runtime_folder):
    sender = PedalSender()
    assert not sender.send(PedalState(0.5, False))
    for travel in (0.25, 0.75):
        pedal = LocalPedal()
        assert sender.send(PedalState(travel, True))
        assert pedal.read()[:2] == (travel, True)
        pedal.close()
        assert not sender.send(PedalState(travel, True))
    sender.close()


def test_the_in_process_pedal_can_be_lost():
    pedal = InProcessPedal()
    assert pedal.read() is None
    pedal.put(PedalState(1.0, False))
    assert pedal.read() == wired(PedalState(1.0, False))
    pedal.put(None)
    with pytest.raises(DeviceMissing):
        pedal.read()


@pytest.mark.parametrize("travel", [math.nan, math.inf, -0.01, 1.01])
def test_no_pedal_has_such_a_travel(travel):
    assert not check_pedal(PedalState(travel, False))
