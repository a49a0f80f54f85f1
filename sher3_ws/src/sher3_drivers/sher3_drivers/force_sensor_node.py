"""The force sensor on a topic: one raw reading per tick; the logic is in the back-end and `wrench_checks`.

What the numbers themselves show (range, saturation, a frozen sensor) is published raw and reported: every consumer
judges the numbers. What only the device knows (its status word) is published as NaN, so that nobody moves on it.
When no record comes there is no sample: silence stops the robot.
"""

from __future__ import annotations

import math
from typing import Any

from rclpy.node import Node
from sher3_description import Robot
from sher3_runtime import NODE_OPTIONS, DiagnosticSample, WrenchSample, advertise, on_tick

from .force_sensor import ForceSensorDevice
from .wrench_checks import WrenchFault, WrenchLimits, WrenchWatch, check_wrench, wrench_readings

NOT_A_WRENCH = (math.nan,) * 6
REPORT_PERIOD = 0.1
PHASE = 1e-5
"""Delay of the reading behind the tick, s: in stepped time the drives' SYNC comes first."""
WAIT = 0.8
"""Share of the period that a tick waits for its record."""


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
        self._limits = WrenchLimits.of(robot.force_sensor)
        self._watch = WrenchWatch()
        self._faults: dict[WrenchFault, int] = {}
        self._newest = WrenchFault.NONE
        self._wait = WAIT * robot.control_period
        self._publish = advertise(self, "force/measured_cf")
        self._publish_report = advertise(self, "diagnostics")
        on_tick(self, self._tick, phase)
        period = robot.control_period
        on_tick(self, self._report, 0.5 * period, max(1, round(REPORT_PERIOD / period)))

    def _tick(self, stamp: int) -> None:
        record = self._device.read(stamp, self._wait)
        self._watch, fault = check_wrench(self._watch, record, self._limits)
        if fault is not WrenchFault.NONE:
            self._count(fault)
        if record is not None:
            self._publish(WrenchSample(stamp, NOT_A_WRENCH if fault is WrenchFault.DEVICE else record.wrench))

    def _count(self, fault: WrenchFault) -> None:
        if fault not in self._faults:
            self.get_logger().warning(f"force sensor: {fault.value}; further ones are only counted")
        self._faults[fault] = self._faults.get(fault, 0) + 1
        self._newest = fault

    def _report(self, stamp: int) -> None:
        fault, self._newest = self._newest, WrenchFault.NONE
        level = 2 if fault.severe else 0 if fault is WrenchFault.NONE else 1
        values = [(f.name.lower(), str(count)) for f, count in self._faults.items()]
        values.append(("lost_records", str(self._watch.lost)))
        values.append(("misfit_records", str(getattr(self._device, "misfits", 0))))
        values += wrench_readings(self._watch, self._limits)
        self._publish_report(DiagnosticSample(stamp, "force_sensor: readings", level, fault.value, tuple(values)))

    def close(self) -> None:
        """Stop the stream."""
        self._device.close()
