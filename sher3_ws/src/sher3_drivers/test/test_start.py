"""The start of the drives on a busy machine: what was kept back on the way must not keep the robot from starting."""

from __future__ import annotations

import itertools

from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.drive.setup import set_up_drives
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale

ROBOT = load_robot()


class HeldUpHost:
    """A host's link whose process is held up behind each frame it sends: the drives have answered before it listens.

    The drives' side runs only when it is sent something, as a process does that waits for frames.
    """

    def __init__(self, link, drives):
        self._link, self._drives, self.name = link, drives, link.name
        self.fileno, self.recv_frames, self.close = link.fileno, link.recv_frames, link.close

    def send_frames(self, frames):
        self._link.send_frames(frames)
        self._drives.poll()


def test_an_answer_that_is_kept_back_does_not_keep_the_drives_from_starting(runtime_folder):
    """The host reads channel 0 only after channel 1 is configured; the drives' heartbeats have filled its queue then.

    Their one answer to the start command waits behind them, and nothing but a further frame brings it on its way.
    """
    settings = default_settings(links=("local:start0", "local:start1"))
    ends = [[open_link(channel.link) for channel in settings.channels] for _ in range(2)]
    time = itertools.count(10**12, 10_000_000)
    bus = MockDriveBus(ends[0], IntegratorPlant(ROBOT, settings.period), ROBOT, settings, lambda: next(time))
    hosts = [HeldUpHost(link, bus) for link in ends[1]]
    try:
        set_up_drives(hosts, settings, [AxisScale.from_actuator(a) for a in ROBOT.actuators], patience=2.0)
        assert all(drive.node.operational for drive in bus.drives.values())
    finally:
        for link in (*ends[0], *ends[1]):
            link.close()
