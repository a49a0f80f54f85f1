"""The pedal on a topic: its state at every tick, with the stamp of the tick. All logic is in the back-end.

A pedal that was lost is published as a travel of NaN with the emergency stop pressed. Nobody may move on a pedal that
is not there, and its stop button is not there either.
"""

from __future__ import annotations

from typing import Any

from rclpy.node import Node
from sher3_common.samples import DiagnosticSample, JoySample
from sher3_description import Robot
from sher3_runtime import NODE_OPTIONS, advertise, on_tick

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import PedalDevice, PedalState, check_pedal
from sher3_drivers.pedal.plausible import LOST, PedalWatch

PHASE = 1e-5
"""Delay of the reading behind the tick, s: in stepped time the drives' SYNC comes first."""
REPORT_PERIOD = 0.1
"""Time between two diagnostics, s."""


class PedalNode(Node):
    """Publisher of `pedal/measured`.

    Args:
        robot: the robot, for the period.
        device: the pedal: `HidPedal`, `LocalPedal` or `InProcessPedal`.
        phase: delay of the reading behind the tick, s.
    """

    def __init__(self, robot: Robot, device: PedalDevice, phase: float = PHASE, **options: Any) -> None:
        super().__init__("pedal", **{**NODE_OPTIONS, **options})
        self._device = device
        self._fault: str | None = None
        self._heard = False
        self._watch = PedalWatch()
        self._publish = advertise(self, "pedal/measured")
        self._publish_report = advertise(self, "diagnostics")
        on_tick(self, self._tick, phase)
        period = robot.control_period
        on_tick(self, self._report, 0.5 * period, max(1, round(REPORT_PERIOD / period)))

    def _tick(self, stamp: int) -> None:
        state = self._read(stamp)
        if state is not None:
            self._heard = True
            self._publish(JoySample(stamp, (state.travel,), (int(state.emergency_stop),)))

    def _read(self, stamp: int) -> PedalState | None:
        """Return the state as the robot may use it, see `pedal.plausible`; None before the pedal said anything."""
        try:
            state = self._device.read()
        except DeviceMissing as error:
            return self._lost(str(error))
        if state is None:
            return None
        if not check_pedal(state):
            return self._lost(f"travel {state.travel} is not from 0 to 1")
        state = self._watch.judge(state, stamp)
        if self._watch.fault is not None:
            self._note(self._watch.fault)
        else:
            self._fault = None
        return state

    def _lost(self, why: str) -> PedalState:
        self._note(why)
        return LOST

    def _note(self, why: str) -> None:
        if self._fault is None:
            self.get_logger().error(why)
        self._fault = why

    def _report(self, stamp: int) -> None:
        message = self._fault or ("ok" if self._heard else "the pedal has not said anything yet")
        level = 2 if self._fault else 0 if self._heard else 3
        self._publish_report(DiagnosticSample(stamp, "pedal: device", level, message))

    def close(self) -> None:
        """Let the device go."""
        self._device.close()
