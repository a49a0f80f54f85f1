"""The same promises on every CAN back-end (after python-can's back2back_test.py)."""

import os
import select
import subprocess
import sys

import can
import pytest
from sher3_drivers.bus import LinkGroup, LockstepLink, open_link, wait_frames
from sher3_drivers.bus_local import LocalLink, runtime_directory
from sher3_drivers.bus_python_can import LinkBus
from sher3_drivers.bus_virtual import VirtualLink
from sher3_drivers.errors import FrameError, LinkError
from sher3_drivers.frame import Frame, pack_frames


def burst(count, start=0):
    return pack_frames(Frame(0x100 + (start + i) % 0x600, (start + i).to_bytes(8, "little")) for i in range(count))


def drain(link):
    """Everything that comes within 50 ms of the last frame."""
    received = b""
    while part := wait_frames(link, 0.05):
        received += part
    return received


def test_frames_arrive_in_order_and_whole(open_pair):
    a, b = open_pair(), open_pair()
    a.recv_frames()
    a.send_frames(burst(16))
    a.send_frames(burst(3, 16))
    assert drain(b) == burst(19)
    assert a.recv_frames() == b""
    assert b.received_at > 0


def test_both_ways_among_three(open_pair):
    links = [open_pair() for _ in range(3)]
    for link in links:
        link.recv_frames()
    links[2].send_frames(burst(1))
    links[0].send_frames(burst(1, 7))
    assert drain(links[1]) in (burst(1) + burst(1, 7), burst(1, 7) + burst(1))
    assert drain(links[0]) == burst(1)
    assert drain(links[2]) == burst(1, 7)


def test_late_joiner_is_heard_and_hears(open_pair):
    first = open_pair()
    first.send_frames(burst(1))
    late = open_pair()
    assert late.recv_frames() == b""
    late.send_frames(burst(2))
    assert drain(first) == burst(2)
    first.send_frames(burst(3))
    assert drain(late) == burst(3)


def test_leaving_does_not_disturb_the_others(open_pair):
    links = [open_pair() for _ in range(3)]
    for link in links:
        link.recv_frames()
    links[1].close()
    links[1].close()
    links[0].send_frames(burst(5))
    assert drain(links[2]) == burst(5)


def test_a_part_of_a_frame_is_refused(open_pair):
    link = open_pair()
    with pytest.raises(FrameError):
        link.send_frames(b"\x00" * 17)


def test_a_closed_link_refuses(open_pair):
    link = open_pair()
    link.close()
    with pytest.raises((LinkError, OSError)):
        link.send_frames(burst(1))


def test_a_lagging_reader_loses_nothing_within_the_bound(open_pair):
    """60 datagrams are six times what the kernel queues for an AF_UNIX socket."""
    if open_pair.kind == "socketcan":
        pytest.skip("socketcan's queue lengths are the interface's")
    a, b = open_pair(), open_pair()
    a.recv_frames()
    received = b""
    for k in range(60):
        a.send_frames(burst(8, 8 * k))
    for _ in range(60):
        received += b.recv_frames()
        a.send_frames(b"")
    assert received == burst(480)
    assert a.dropped == 0


def test_beyond_the_bound_frames_are_dropped_and_counted(open_pair):
    if open_pair.kind == "socketcan":
        pytest.skip("socketcan's queue lengths are the interface's")
    a, b = open_pair(), open_pair()
    a.recv_frames()
    for k in range(6):
        for _ in range(10):
            a.send_frames(burst(100, k))
    for _ in range(2000):
        a.send_frames(burst(16))
    received = 0
    while part := b.recv_frames():
        received += len(part) // 16
        a.send_frames(b"")
    assert a.dropped > 0
    assert received + a.dropped == 6000 + 2000 * 16


def test_python_can_messages_over_the_link(open_pair):
    with LinkBus(open_pair()) as a, LinkBus(open_pair()) as b:
        a.recv(0)
        sent = can.Message(arbitration_id=0x601, data=b"\x40\x00\x10\x00", is_extended_id=False)
        a.send(sent)
        received = b.recv(1.0)
        assert received is not None and received.equals(sent, timestamp_delta=None, check_channel=False)
        assert b.recv(0.0) is None


def test_lockstep_runs_the_other_side(open_pair):
    a, b = open_pair(), open_pair()
    stepped = LockstepLink(a)
    stepped.attach(lambda: b.send_frames(b.recv_frames()))
    a.recv_frames()
    stepped.send_frames(burst(4))
    assert stepped.recv_frames() == burst(4)
    assert stepped.fileno() == -1 and LinkGroup([stepped]).receive(10.0) == []


@pytest.mark.skipif("sher3" not in can.VALID_INTERFACES, reason="installed without the can.interface entry point")
def test_python_can_finds_the_interface_by_name(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with can.Bus(interface="sher3", channel="local:tools") as bus:
        assert bus.recv(0.0) is None


def test_a_killed_participant_is_forgotten_and_its_socket_removed(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    script = "import time, sher3_drivers.bus as b; a = b.open_link('local:kill'); print(flush=True); time.sleep(9)"
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, env=dict(os.environ))
    assert process.stdout is not None and process.stdout.readline() == b"\n"
    link = LocalLink("kill")
    directory = runtime_directory() / "can" / "kill"
    assert len(list(directory.iterdir())) == 2
    process.kill()
    process.wait()
    link.send_frames(burst(1))
    assert len(list(directory.iterdir())) == 1
    link.close()
    assert not list(directory.iterdir())


def test_wait_sees_frames_of_any_link(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    group, other = LinkGroup([LocalLink("a"), LocalLink("b")]), LocalLink("b")
    group.links[1].recv_frames()
    assert group.receive(0.0) == []
    other.send_frames(burst(1))
    assert group.receive(1.0) == [(1, burst(1))]
    assert select.select(group.links, (), (), 0)[0] == []
    group.close()
    other.close()


def test_a_link_that_fails_is_left_alone_and_the_others_go_on(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    group, other = LinkGroup([LocalLink("a"), LocalLink("b")]), LocalLink("b")

    def down():
        raise LinkError("cannot receive: network is down", link="local:a")

    group.links[0].recv_frames = down
    LocalLink("a").send_frames(burst(1))
    other.send_frames(burst(2))
    group.links[1].recv_frames()
    other.send_frames(burst(2))
    assert group.receive(1.0) == [(1, burst(2))]
    assert list(group.failures) == [0]
    assert group.receive(0.0) == []


@pytest.mark.parametrize("specification", ["can0", "usb:can0", "local:", "local:../x", "local:" + "x" * 40])
def test_bad_specifications_are_named(specification, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with pytest.raises(LinkError, match="limit"):
        open_link(specification)


def test_a_missing_interface_names_the_remedy():
    with pytest.raises(LinkError, match="bring it up"):
        open_link("socketcan:nonexistent9")


def test_a_shared_runtime_directory_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "sher3").mkdir(mode=0o777)
    (tmp_path / "sher3").chmod(0o777)
    with pytest.raises(LinkError, match="not private"):
        LocalLink("x")


def test_virtual_channels_do_not_leak():
    a = VirtualLink("leak")
    VirtualLink("leak")  # never closed: collected
    a.send_frames(burst(1))
    assert a.dropped == 0
