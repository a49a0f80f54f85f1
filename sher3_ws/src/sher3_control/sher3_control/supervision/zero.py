"""Is the zero of the force sensor earned? Before the drives get their power nothing but the tool hangs on the sensor.

Whatever is there at enabling would be taken for right, and followed as soon as the pedal is pressed. So the robot is
enabled only while the sensor reads what the tool's known weight and the tare explain. The limits lie below the law's
dead bands: a zero that passes moves nothing by itself, however old the tare is.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from contextlib import suppress

import numpy as np
from sher3_common.reasons import Reason
from sher3_common.stamps import NO_STAMP, age
from sher3_common.vectors import ZERO_WRENCH, Vector, Wrench
from sher3_description import ACTUATORS, Robot
from sher3_kinematics.kernel import kernel_parameters

from sher3_control.errors import SettingsError
from sher3_control.law.angles import roll_and_tilt
from sher3_control.law.live_parameters import from_json
from sher3_control.law.tool_compensation import contact_wrench, tip_rotation, wrench_at_tip
from sher3_control.settings import TareSettings
from sher3_control.supervision.detectors import Finding, PlainDetector

COMPONENTS = ("force x", "force y", "force z", "torque x", "torque y", "torque z")
"""Components of the wrench at the tip in {t}."""
UNITS = ("N", "N", "N", "N m", "N m", "N m")
NEW = 0.1
"""Oldest newest sample that tells of a zero [s], as of any stream that is watched."""
ROLL, TILT = ACTUATORS.index("roll"), ACTUATORS.index("tilt")


class ToolContact:
    """From what the sensor reads to what touches the tip, as the law takes it.

    Attributes:
        bias: of the tare in force (6,) in {f} [N], [N m].
    """

    def __init__(self, robot: Robot) -> None:
        sensor = robot.force_sensor
        self._mass, self._com, self._position = float(sensor.tool_mass), sensor.tool_com, sensor.position
        self._kernel = np.array(kernel_parameters(robot))
        self.bias: Wrench = ZERO_WRENCH

    def hear(self, settings: str) -> None:
        """Take the bias from the text of `admittance/settings`; a damaged text leaves the one in force."""
        with suppress(SettingsError):
            self.bias = from_json(settings)[0].bias

    def at_tip(self, wrench: Wrench, q: Vector) -> Wrench:
        """Return the contact wrench at the tip in {t}, of a raw one in {f} and load encoders (5,) of the same tick."""
        turned = tip_rotation(*roll_and_tilt(self._kernel, q[ROLL], q[TILT]))
        return wrench_at_tip(contact_wrench(wrench, turned, self._mass, self._com, self.bias), self._position)


class ZeroDetector(PlainDetector):
    """Bars arming while the mean of the contact wrench is beyond what a resting tool may show.

    Args:
        settings: `drift_force`, `drift_torque`, `arming_samples`.
    """

    def __init__(self, settings: TareSettings) -> None:
        self._limits = np.repeat((settings.drift_force, settings.drift_torque), 3)
        self._samples: deque[Vector] = deque(maxlen=settings.arming_samples)
        self.begin()

    def begin(self) -> None:
        """Forget the samples: the drives have power, and the wrench is a hand's."""
        self._samples.clear()
        self._newest, self._rests = NO_STAMP, False

    def rest(self, contacts: Iterable[tuple[int, Vector]]) -> None:
        """Take stamps [ns] and contact wrenches at the tip (6,) of ticks without power."""
        self._rests = True
        for self._newest, contact in contacts:
            self._samples.append(contact)

    def look(self, now: int) -> Finding:
        """Return the component that is farthest from zero; without power it is infinite where nothing new is known."""
        mean = np.zeros(6)
        if self._rests:
            mean = np.mean(self._samples, axis=0) if age(now, self._newest) <= NEW else np.full(6, np.inf)
        share = np.abs(mean) / self._limits
        k = int(np.argmax(share))
        source = f"force sensor, {COMPONENTS[k]}"
        return Finding(Reason.FORCE_UNEXPLAINED, float(abs(mean[k])), float(self._limits[k]), UNITS[k], source)
