"""The plant process on mocks: the robot behind the CAN links, the force sensor's cable and the pedal's.

The plant takes a step at each SYNC of the mock drives. The wrench on the tip and the foot on the pedal arrive on
`mock/contact_wrench` and `mock/pedal`; a sender that falls silent counts as having let go of both. Faults of the
devices are requested on `mock/fault`; from the first request on the plant publishes the true positions on
`mock/true_js`, for whoever measures. Effects are exchanged on `mock/effects`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, cast

import numpy as np
from rclpy.node import Node
from sher3_common import Sher3Error
from sher3_common.samples import (
    DiagnosticSample,
    JointSample,
    JoySample,
    PoseSample,
    TemperatureSample,
    TextSample,
    WrenchSample,
)
from sher3_description import Robot
from sher3_drivers.bus.link import CanLink, open_links
from sher3_drivers.mock.bus import DrivePlant, MockDriveBus
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.pedal.local import PedalSender
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.sensor.netft_server import NetFtServer
from sher3_drivers.settings import MotorDriverSettings, default_settings
from sher3_runtime import NODE_OPTIONS, advertise, clock_of, on_readable, on_tick, subscribe

from sher3_sim.effect import PlantEffect
from sher3_sim.plant import Plant, Reading
from sher3_sim.scatter import RunScatter

HOLD = 0.2
"""Time [s] after which a wrench or a pedal position that is no longer sent counts as let go."""
RELEASED = PedalState(0.0, False)
NOTHING = (0.0,) * 6
MAX_CONTACT = 1000.0
"""Largest contact [N, N m] that is accepted: far beyond any hand, and no encoder overflows its 32 bits under it."""


class Faults(Protocol):
    """The injector that breaks the devices on request; see `sher3_faults.injector`."""

    def take(self, text: str, now: int) -> object:
        """Take a request of `mock/fault` at `now` [ns]; raise a Sher3Error when it cannot be done."""

    def poll(self, now: int) -> None:
        """Let what is due begin and end."""

    def report(self) -> tuple[int, str, tuple[tuple[str, str], ...]]:
        """Return level, sentence and values for `/diagnostics`."""


class PlantNode(Node):
    """The simulated robot with its mock devices.

    Args:
        robot: The nominal robot.
        settings: CAN channels and period; by default the local links and the robot's control period.
        effects: What the plant does that the nominal model does not.
        seed: Seed of all noise.
        scatter: Run-to-run variation, drawn from the seed.
        links: Opened links instead of those that the settings name (stepped tests).
        force_device: Device end of the force sensor; by default one on its standard port.
        pedal_device: Device end of the pedal, or the name of its socket.
        faults: Makes the injector from what can break (drives, sensor, pedal); without it `mock/fault` is ignored.
        effects_of: Makes effects from a text of `mock/effects`; without it nobody listens.

    Attributes:
        plant: The simulated robot.
        reading: What its sensors said at the newest step.

    Raises:
        EffectError: An effect does not fit the robot.
        LinkError, DeviceMissing: A link or a port is taken.
    """

    def __init__(
        self,
        robot: Robot,
        settings: MotorDriverSettings | None = None,
        effects: Iterable[PlantEffect] = (),
        seed: int = 0,
        scatter: RunScatter | None = None,
        links: Sequence[CanLink] | None = None,
        force_device: NetFtServer | InProcessForceSensor | None = None,
        pedal_device: PedalSender | InProcessPedal | str = "pedal",
        faults: Callable[[MockDriveBus, Any, Any], Faults] | None = None,
        effects_of: Callable[[str], Iterable[PlantEffect]] | None = None,
        **options: Any,
    ) -> None:
        super().__init__("plant", **{**NODE_OPTIONS, **options})
        settings = settings or default_settings(robot.control_period)
        self._now, self._period = clock_of(self).now, robot.control_period
        self.plant = Plant(robot, effects, seed, scatter=scatter)
        self.reading = self.plant.reset(np.zeros(5))
        self._wrench: tuple[float, ...] = NOTHING
        self._wrench_at = 0
        self._foot, self._foot_at = RELEASED, 0
        self._streamed = self._tip_stamp = -1
        self._force = force_device if force_device is not None else NetFtServer()
        self._pedal = PedalSender(pedal_device) if isinstance(pedal_device, str) else pedal_device
        self._say_wrench: Callable[[Any], object] = (
            self._force.publish if isinstance(self._force, NetFtServer) else self._force.put
        )
        self._say_pedal: Callable[[PedalState], object] = (
            self._pedal.send if isinstance(self._pedal, PedalSender) else self._pedal.put
        )
        if links is None:
            links = open_links([channel.link for channel in settings.channels])
        self.drives = MockDriveBus(links, cast(DrivePlant, self), robot, settings, self._now)
        self._faults = None if faults is None else faults(self.drives, self._force, self._pedal)
        self._truth_said = False
        self._publish_truth = advertise(self, "mock/true_js")
        self._publish_report = advertise(self, "diagnostics")
        self._publish_tip = advertise(self, "tracker/measured_cp")
        self._publish_temperature = advertise(self, "temperature")
        subscribe(self, "mock/contact_wrench", self._on_wrench)
        subscribe(self, "mock/pedal", self._on_pedal)
        subscribe(self, "mock/fault", self._on_fault)
        if effects_of is not None:
            self._effects_of = effects_of
            subscribe(self, "mock/effects", self._on_effects)
        for link in links:
            if link.fileno() >= 0:
                on_readable(self, link, self._serve)
        if isinstance(self._force, NetFtServer):
            on_readable(self, self._force, self._force.poll)
        self._alone = on_tick(self, self._tick, 0.5 * self._period)
        on_tick(self, self._second, 0.5 * self._period, max(1, round(1.0 / self._period)))

    def step(self, velocity_command: Sequence[float]) -> Reading:
        """Advance the plant by one period, as `MockDriveBus` asks at a SYNC, and let the sensors speak."""
        fresh = self._now() - self._wrench_at < HOLD * 1e9
        self.reading = reading = self.plant.step(velocity_command, self._wrench if fresh else NOTHING)
        stamp = self._stamp()
        self._stream(stamp)
        if self._truth_said:
            self._tell_truth()
        else:
            self._press()
            self._alone.done(stamp)
        # A SYNC that comes a period late would give its sample the stamp of the next one.
        if reading.tracker is not None and stamp > self._tip_stamp:
            self._tip_stamp, pose = stamp, reading.tracker.tolist()
            self._publish_tip(PoseSample(stamp, tuple(pose[:3]), tuple(pose[3:])))
        return reading

    def _serve(self) -> None:
        self.drives.serve(0.0)  # the executor calls again at once when more has come

    def _tell_truth(self) -> None:
        """Publish the true positions of the axes at the end of the step."""
        position, demand = self.plant.true_position.tolist(), self.reading.demand.tolist()
        self._publish_truth(JointSample(self.drives.step_end, tuple(position), tuple(demand)))

    def _stamp(self) -> int:
        """Return the stamp of the present tick; SYNCs come at the ticks or a little later."""
        period = round(self._period * 1e9)
        return self._now() // period * period

    def _stream(self, stamp: int) -> None:
        self._streamed = stamp
        self._say_wrench(tuple(self.reading.wrench.tolist()))

    def _press(self) -> None:
        self._say_pedal(self._foot if self._now() - self._foot_at < HOLD * 1e9 else RELEASED)

    def _tick(self, stamp: int) -> None:
        """Send for the devices that have a clock of their own: sensor and pedal go on when no SYNC comes."""
        if self._faults is not None:
            self._faults.poll(self._now())
        self.drives.poll()
        if self._streamed != stamp:
            self._stream(stamp)
        self._press()

    def _second(self, stamp: int) -> None:
        self._publish_temperature(TemperatureSample(stamp, self.reading.temperature))

    def _on_wrench(self, sample: WrenchSample) -> None:
        if all(abs(value) <= MAX_CONTACT for value in sample.wrench):  # a NaN compares false
            self._wrench, self._wrench_at = sample.wrench, self._now()
        else:
            self.get_logger().error(f"mock/contact_wrench beyond {MAX_CONTACT:g} N, N m was ignored: {sample.wrench}")

    def _on_pedal(self, sample: JoySample) -> None:
        if len(sample.axes) == 1 and len(sample.buttons) <= 1:
            self._foot, self._foot_at = PedalState(sample.axes[0], any(sample.buttons)), self._now()
            return
        found = f"{len(sample.axes)} axes and {len(sample.buttons)} buttons"
        self.get_logger().error(
            f"mock/pedal was ignored: {found}; send one axis, the travel, and at most one button, the emergency stop",
            once=True,
        )

    def _on_fault(self, sample: TextSample) -> None:
        if self._faults is None:
            return
        self._truth_said = True
        try:
            self._faults.take(sample.text, self._now())
        except Sher3Error as error:
            self.get_logger().error(str(error))
        self._publish_report(DiagnosticSample(self._now(), "plant: faults", *self._faults.report()))

    def _on_effects(self, sample: TextSample) -> None:
        level, message, effects = 0, "exchanged", []
        try:
            effects = list(self._effects_of(sample.text))
            self.plant.exchange(effects)
        except Sher3Error as error:
            level, message = 1, str(error)
            self.get_logger().error(message)
        values = tuple((effect.id, effect.actuator) for effect in effects)
        self._publish_report(DiagnosticSample(self._now(), "plant: effects", level, message, values))

    def close(self) -> None:
        """Take the devices off their lines."""
        self.drives.close()
        self._force.close()
        self._pedal.close()
