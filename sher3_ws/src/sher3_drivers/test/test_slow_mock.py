"""Mock drives on a computer that makes their steps slower than time goes: they answer all the same."""

from sher3_description import load_robot
from sher3_drivers.bus.frame import pack_frame
from sher3_drivers.bus.link import open_link
from sher3_drivers.canopen import objects as od
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.settings import default_settings

ROBOT = load_robot()
PERIOD = 2_000_000
SYNC = pack_frame(od.SYNC_ID, b"")


class SlowPlant(IntegratorPlant):
    """Each step takes as long as 1.5 periods."""

    now = 10**12

    def step(self, velocity_command):
        self.now += 3 * PERIOD // 2
        return super().step(velocity_command)


def test_a_call_ends_although_every_step_takes_longer_than_its_period():
    """Held up for a second, 500 steps would take 1.5 s, in which 750 more would be due, and so on.

    It makes up for 50 ms, and answers what waited: 20 SYNCs, 3 ms each.
    """
    settings = default_settings(links=("virtual:slow0", "virtual:slow1"))
    ends = [[open_link(channel.link) for channel in settings.channels] for _ in range(2)]
    plant = SlowPlant(ROBOT, settings.period)
    bus = MockDriveBus(ends[0], plant, ROBOT, settings, lambda: plant.now)
    for _ in range(4):
        answered = bus.ticks
        for _ in range(20):
            for host in ends[1]:
                host.send_frames(SYNC)
        begin = plant.now = plant.now + 10**9
        bus.poll()
        assert plant.now - begin < 120_000_000
        assert bus.ticks > answered
    for link in (*ends[0], *ends[1]):
        link.close()
