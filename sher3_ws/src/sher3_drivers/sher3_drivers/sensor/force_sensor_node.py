"""The force sensor on a topic: one raw reading per tick. The logic is in the back-end and in `sensor.health`.

Faults that the numbers themselves show (range, saturation, a frozen sensor) are published raw and reported, because
every consumer judges the numbers. A fault that only the device knows, its status word, is published as NaN, so that
nobody moves on it. When no record comes there is no sample: silence stops the robot.
"""

from __future__ import annotations

import math
from typing import Any

from rclpy.node import Node
from sher3_common.samples import DiagnosticSample, WrenchSample
from sher3_description import Robot
from sher3_runtime import NODE_OPTIONS, advertise, on_tick

from sher3_drivers.sensor.device import ForceSensorDevice
from sher3_drivers.sensor.health import SensorFault, SensorHealth, SensorLimits, judge_record, sensor_readings

NOT_A_WRENCH = (math.nan,) * 6
REPORT_PERIOD = 0.1
"""Time between two diagnostics, s."""
PHASE = 1e-5
"""Delay of the reading behind the tick, s: in stepped time the drives' SYNC comes first."""
WAIT = 0.8
"""Share of the period that a tick waits for its record."""


_UNUSABLE = (SensorFault.DEVICE, SensorFault.ABSURD)
"""Faults that nobody else can see in the numbers."""


class ForceSensorNode(Node):
    """Publisher of `force/measured_cf`.

    Args:
        robot: the robot, for range and period.
        device: the sensor, `NetFtSensor` or `InProcessForceSensor`.
        phase: delay of the reading behind the tick, s.
    """

    def __init__(self, robot: Robot, device: ForceSensorDevice, phase: float = PHASE, **options: Any) -> None:
        super().__init__("force_sensor", **{**NODE_OPTIONS, **options})
        self._device = device
        self._limits = SensorLimits.of(robot.force_sensor)
        self._health = SensorHealth()
        self._faults: dict[SensorFault, int] = {}
        self._newest = SensorFault.NONE
        self._wait = WAIT * robot.control_period
        self._publish = advertise(self, "force/measured_cf")
        self._publish_report = advertise(self, "diagnostics")
        on_tick(self, self._tick, phase)
        period = robot.control_period
        on_tick(self, self._report, 0.5 * period, max(1, round(REPORT_PERIOD / period)))

    def _tick(self, stamp: int) -> None:
        record = self._device.read(stamp, self._wait)
        self._health, fault = judge_record(self._health, record, self._limits)
        if fault is not SensorFault.NONE:
            self._count(fault)
        if record is not None:
            self._publish(WrenchSample(stamp, NOT_A_WRENCH if fault in _UNUSABLE else record.wrench))

    def _count(self, fault: SensorFault) -> None:
        if fault not in self._faults:
            self.get_logger().warning(f"force sensor: {fault.value}; further ones are only counted")
        self._faults[fault] = self._faults.get(fault, 0) + 1
        self._newest = fault

    def _report(self, stamp: int) -> None:
        fault, self._newest = self._newest, SensorFault.NONE
        level = 2 if fault.severe else 0 if fault is SensorFault.NONE else 1
        values = [(f.name.lower(), str(count)) for f, count in self._faults.items()]
        values.append(("lost_records", str(self._health.lost)))
        values.append(("misfit_records", str(getattr(self._device, "misfits", 0))))
        values += sensor_readings(self._health, self._limits)
        self._publish_report(DiagnosticSample(stamp, "force_sensor: readings", level, fault.value, tuple(values)))

    def close(self) -> None:
        """Stop the stream."""
        self._device.close()
