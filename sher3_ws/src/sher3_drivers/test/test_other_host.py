"""A second host on a bus is refused before it has said a word, and the robot that the first one moves goes on."""

from __future__ import annotations

import threading
import time

import pytest
from sher3_description import load_robot
from sher3_drivers.bus.frame import pack_frame
from sher3_drivers.bus.link import open_link, open_links
from sher3_drivers.canopen.other_host import LISTEN, refuse_other_host
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.errors import OtherHost

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]


def second_links(rig):
    """Join the channels of a rig as one more participant of each."""
    return open_links([link.name for link in rig.device_links])


def test_a_second_motor_driver_is_refused_and_the_robot_goes_on(rig):
    rig.tick(SLOW)
    links = second_links(rig)
    for _ in range(3):
        rig.tick(SLOW)
    with pytest.raises(OtherHost, match=r"there is another host.* limit one on a bus.*end the other") as caught:
        MotorDriver(ROBOT, rig.settings, links).configure()
    assert caught.value.link in [link.name for link in links]
    before = list(rig.plant.position)
    for _ in range(20):
        rig.tick(SLOW)
    travel = [b - a for a, b in zip(before, rig.plant.position, strict=True)]
    assert travel == pytest.approx([20 * v * rig.settings.period for v in SLOW], rel=1e-5)
    assert rig.driver.enabled and rig.driver.stop.first is None
    for link in links:
        link.close()


def test_where_the_first_host_has_gone_the_next_one_starts(rig):
    """Drives that still run say nothing that a host says."""
    rig.tick(SLOW)
    links = second_links(rig)
    rig.idle(100)
    refuse_other_host(links, rig.settings.host_id)
    for link in links:
        link.close()


SAYS = [
    (0x000, b"\x01\x00", "NMT command"),
    (0x080, b"", "SYNC"),
    (0x77F, b"\x05", "heartbeat of node 127"),
    (0x203, bytes(6), "RPDO"),
    (0x602, bytes(8), "SDO request"),
]


@pytest.mark.parametrize(("can_id", "data", "said"), SAYS)
def test_everything_that_only_a_host_says_is_known(can_id, data, said):
    ours, other = open_link("virtual:says"), open_link("virtual:says")
    other.send_frames(pack_frame(can_id, data))
    with pytest.raises(OtherHost, match=said):
        refuse_other_host([ours], 127)


@pytest.mark.parametrize("can_id", [0x081, 0x183, 0x285, 0x582, 0x703, 0x710, 0x20000088])
def test_what_drives_sensors_and_controllers_say_is_no_host(can_id):
    ours, other = open_link("virtual:says"), open_link("virtual:says")
    other.send_frames(pack_frame(can_id, bytes(8)))
    refuse_other_host([ours], 127)


def test_it_listens_for_a_while_where_frames_can_be_waited_for(runtime_folder):
    ours, other = open_link("local:listen"), open_link("local:listen")
    begin = time.monotonic()
    refuse_other_host([ours], 127)
    assert time.monotonic() - begin >= LISTEN
    late = threading.Timer(0.01, other.send_frames, [pack_frame(0x080)])
    late.start()
    with pytest.raises(OtherHost, match="SYNC"):
        refuse_other_host([ours], 127, seconds=10.0)
    late.join()
    ours.close()
    other.close()
