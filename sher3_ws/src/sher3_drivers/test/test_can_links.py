"""The same promises on every CAN back-end (after python-can's back2back_test.py)."""

import os
import select
import subprocess
import sys

import can
import pytest
from sher3_drivers.bus.frame import Frame, bundle, pack_frames
from sher3_drivers.bus.group import LinkGroup
from sher3_drivers.bus.link import open_link, open_links, wait_frames
from sher3_drivers.bus.local import LocalLink
from sher3_drivers.bus.lockstep import LockstepLink
from sher3_drivers.bus.python_can import LinkBus
from sher3_drivers.bus.virtual import VirtualLink
from sher3_drivers.errors import FrameError, LinkError
from sher3_drivers.runtime_directory import runtime_directory


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


OWN_QUEUES = pytest.mark.parametrize("open_pair", ["virtual", "local"], indirect=True)
"""Links whose queues are their own; those of socketcan belong to the interface."""


@OWN_QUEUES
def test_a_lagging_reader_loses_nothing_within_the_bound(open_pair):
    """60 datagrams are six times what the kernel queues for an AF_UNIX socket."""
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


@OWN_QUEUES
def test_beyond_the_bound_frames_are_dropped_and_counted(open_pair):
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
    stepped = LockstepLink(a, [lambda: b.send_frames(b.recv_frames())])
    a.recv_frames()
    stepped.send_frames(burst(4))
    assert stepped.recv_frames() == burst(4)
    assert stepped.fileno() == -1 and LinkGroup([stepped]).receive(10.0) == b""


def test_python_can_finds_the_interface_by_name(runtime_folder):
    with can.Bus(interface="sher3", channel="local:tools") as bus:
        assert bus.recv(0.0) is None


def test_a_killed_participant_is_forgotten_and_its_socket_removed(runtime_folder):
    script = "import time, sher3_drivers.bus.link as b; a = b.open_link('local:kill'); print(flush=True); time.sleep(9)"
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


def test_wait_sees_frames_of_any_link(runtime_folder):
    group, other = LinkGroup([LocalLink("a"), LocalLink("b")]), LocalLink("b")
    group.links[1].recv_frames()
    assert group.receive(0.0) == b""
    other.send_frames(burst(1))
    assert group.receive(1.0) == bundle([b"", burst(1)])
    assert select.select(group.links, (), (), 0)[0] == []
    group.close()
    other.close()


def test_a_link_that_fails_is_left_alone_and_the_others_go_on(runtime_folder):
    group, other = LinkGroup([LocalLink("a"), LocalLink("b")]), LocalLink("b")

    def down():
        raise LinkError("cannot receive: network is down", link="local:a")

    group.links[0].recv_frames = down
    LocalLink("a").send_frames(burst(1))
    other.send_frames(burst(2))
    group.links[1].recv_frames()
    other.send_frames(burst(2))
    assert group.receive(1.0) == bundle([b"", burst(2)])
    assert list(group.failures) == [0]
    assert group.receive(0.0) == b""


@pytest.fixture
def cables(runtime_folder):
    """Two participants of three channels each, as groups, and one of channel 1 alone."""
    names = [f"local:c/{i}" for i in range(3)]
    groups = LinkGroup(open_links(names)), LinkGroup(open_links(names))
    alone = open_link("local:c/1")
    yield *groups, alone
    for link in (*groups[0].links, *groups[1].links, alone):
        link.close()


def test_the_channels_of_a_cable_travel_as_one_datagram(cables):
    a, b, alone = cables
    assert a.receive() == b"" and len({link.fileno() for link in a.links}) == 1
    sent = bundle([burst(2), burst(3, 7), burst(1, 20)])
    assert list(a.send(sent)) == []
    assert b.receive(1.0) == sent and b.receive() == b""
    assert alone.recv_frames() == burst(3, 7)
    alone.send_frames(burst(2))
    assert a.receive(1.0) == bundle([b"", burst(2)]) and b.receive(1.0) == bundle([b"", burst(2)])


def test_a_link_of_a_cable_sees_its_channel_alone_and_leaves_the_rest_to_the_others(cables):
    a, b, _ = cables
    a.receive()
    a.send(bundle([burst(2), b"", burst(1, 20)]))
    a.links[0].send_frames(burst(1, 2))
    assert b.links[1].recv_frames() == b""
    assert b.links[0].recv_frames() == burst(3)
    assert b.receive() == bundle([b"", b"", burst(1, 20)])
    assert b.receive() == b"" and b.links[2].recv_frames() == b""


def test_a_closed_cable_fails_on_every_channel(cables):
    a, b, _ = cables
    b.links[1].close()
    assert [channel for channel, _ in b.send(burst(1))] == [0, 1, 2]
    assert b.receive() == b"" and list(b.failures) == [0, 1, 2] and b.receive(0.001) == b""
    assert list(a.send(burst(1))) == []


def test_what_a_lagging_reader_of_a_cable_loses_is_counted_by_channel(cables):
    a, b, alone = cables
    alone.close()
    a.receive()
    for _ in range(200):
        a.send(bundle([burst(50), b"", burst(25)]))
    assert a.links[0].dropped > a.links[2].dropped > 0 == a.links[1].dropped
    received = b""
    while part := b.receive():
        received += part
        a.send(b"")
    assert len(received) // 16 + sum(link.dropped for link in a.links) == 200 * 75


@pytest.mark.parametrize(
    ("names", "text"), [(["local:c/0", "local:c/0"], "twice"), (["local:c/0", "local:c/x"], "number")]
)
def test_a_channel_of_a_cable_is_named_once_and_by_number(names, text, runtime_folder):
    with pytest.raises(LinkError, match=text):
        open_links(names)
    assert not list((runtime_directory() / "can" / "c").iterdir())


def test_links_of_several_kinds_go_together(runtime_folder):
    names = ["local:c/0", "virtual:several", "local:d"]
    a, b = LinkGroup(open_links(names)), LinkGroup(open_links(names))
    a.receive()
    sent = bundle([burst(2), burst(3, 7), burst(1, 20)])
    assert a.send(sent) == [] and b.receive() == sent
    a.close()
    b.close()


@pytest.mark.parametrize(
    "specification", ["can0", "usb:can0", "local:", "local:../x", "local:a/256", "local:" + "x" * 40]
)
def test_bad_specifications_are_named(specification, runtime_folder):
    with pytest.raises(LinkError, match="limit"):
        open_link(specification)


def test_a_missing_interface_names_the_remedy():
    with pytest.raises(LinkError, match="bring it up"):
        open_link("socketcan:nonexistent9")


def test_a_shared_runtime_directory_is_refused(runtime_folder):
    (runtime_folder / "sher3").mkdir(mode=0o777)
    (runtime_folder / "sher3").chmod(0o777)
    with pytest.raises(LinkError, match="not private"):
        LocalLink("x")


def test_virtual_channels_do_not_leak():
    a = VirtualLink("leak")
    VirtualLink("leak")  # never closed: collected
    a.send_frames(burst(1))
    assert a.dropped == 0
