"""Both ends of the wire in one thread and stepped time: motor driver, CAN links, mock drives, a plant. For tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sher3_description import Robot

from sher3_drivers.bus.link import CanLink, open_links
from sher3_drivers.bus.local import LocalCable, LocalLink
from sher3_drivers.bus.lockstep import LockstepLink
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.mock.bus import DrivePlant, MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.settings import MotorDriverSettings


class LockstepCable(LocalCable):
    """A cable whose other end runs whenever this one looks for frames; there is nothing to wait on."""

    def __init__(self, name: str) -> None:
        self.other_side: list[Callable[[], object]] = []
        super().__init__(name)

    def _next(self) -> bytes:
        for poll in self.other_side:
            poll()
        return super()._next()

    def fileno(self) -> int:
        """Nothing to wait on."""
        return -1


class LockstepRig:
    """A driver and five mock drives; nothing happens but in `tick` and `idle`.

    Args:
        robot: the robot.
        settings: channels and limits; their link specifications are not used.
        open_link: opens one more participant of channel i, or the name of a local cable for all channels.
        plant: what the drives drive; ideal integrators by default.

    Attributes:
        driver: the host's side.
        mock: the drives' side.
        now: the stepped time, ns.
        stamp: stamp of the newest tick, ns.
        supervised: the supervisor's heartbeat comes at every tick.
    """

    def __init__(
        self,
        robot: Robot,
        settings: MotorDriverSettings,
        open_link: Callable[[int], CanLink] | str,
        plant: DrivePlant | None = None,
    ) -> None:
        self.settings = settings
        self.plant = plant or IntegratorPlant(robot, settings.period)
        self.now = 1_000_000_000_000
        self.stamp = 0
        self.supervised = True
        self.period_ns = round(settings.period * 1e9)
        count = len(settings.channels)
        other_side: list[Callable[[], object]] = []
        self.device_links: list[CanLink]
        self.host_links: list[CanLink]
        if isinstance(open_link, str):
            self.device_links = open_links([f"local:{open_link}/{i}" for i in range(count)])
            cable = LockstepCable(open_link)
            cable.other_side = other_side
            self.host_links = [LocalLink(f"{open_link}/{i}", cable) for i in range(count)]
        else:
            self.device_links = [open_link(i) for i in range(count)]
            self.host_links = [LockstepLink(open_link(i), other_side) for i in range(count)]
        self.mock = MockDriveBus(self.device_links, self.plant, robot, settings, self.clock)
        other_side.append(self.mock.poll)
        self.driver = MotorDriver(robot, settings, self.host_links, self.clock)
        self._configured = False

    def clock(self) -> int:
        """Return the stepped time."""
        return self.now

    def tick(self, velocity: Sequence[float] | None = None) -> DriveFeedback | None:
        """Run one tick, with a command when there is one; return its feedback."""
        self.now += self.period_ns
        self.stamp += self.period_ns
        if self.supervised:
            self.driver.hear_supervisor()
        self.driver.tick(self.stamp)
        self.driver.collect_positions()
        feedback = self.driver.collect()
        if velocity is not None:
            self.driver.command(self.stamp, velocity)
        return feedback

    def enable(self, limit: int = 20) -> None:
        """Configure once, then tick until every drive is enabled; raise TimeoutError after `limit` ticks."""
        if not self._configured:
            self.driver.configure()
            self._configured = True
        self.driver.enable()
        for _ in range(limit):
            self.tick()
            if self.driver.enabled:
                return
        raise TimeoutError(f"not enabled after {limit} ticks: {self.driver.stop}")

    def states(self) -> set[str]:
        """Return the names of the CiA 402 states the host sees."""
        return {health.state.name if health.state else "unknown" for health in self.driver.session.drives}

    def idle(self, ticks: int) -> None:
        """Let time pass without the host: no SYNC, no heartbeat."""
        for _ in range(ticks):
            self.now += self.period_ns
            self.mock.poll()

    def close(self) -> None:
        """Close both ends, without the wait that a moving robot needs."""
        self.driver.disable()
        self.driver.close()
        self.mock.close()
