"""A law with healthy inputs, to be spoiled by the tests."""

from __future__ import annotations

from itertools import pairwise

from sher3_control import ControlSettings, LawInput, LawOutput, initial_state, step
from sher3_control.law.parameters import law_parameters
from sher3_description import load_robot

T = 2_000_000
START = 1_000_000_000_000_000_000
ROBOT = load_robot()
SETTINGS = ControlSettings.from_robot(ROBOT)
PARAMETERS = law_parameters(ROBOT, SETTINGS)


class LawBench:
    """Run the law tick by tick; `tick(**changes)` starts from healthy inputs with the weight of the tool on the sensor.

    `force` and `torque` act on the tip in {t}; the sensor reads them moved to {f}.
    """

    def __init__(self, parameters=PARAMETERS, settings=SETTINGS):
        self.p, self.settings = parameters, settings
        self.state, self.k = initial_state(), 0

    def healthy(self) -> LawInput:
        stamp = START + self.k * T
        wiggle = 1e-6 * (self.k % 7 - 3)
        weight = -self.p.tool_mass * 9.81
        wrench = (wiggle, wiggle, weight + wiggle, 0.0, 0.0, 0.0)
        a = self.settings.admittance
        return LawInput(
            stamp,
            True,
            True,
            stamp,
            wrench,
            stamp,
            0.0,
            False,
            stamp,
            0.0,
            0.0,
            1.0,
            a.linear_gain,
            a.angular_gain,
            0,
            (0.0,) * 6,
        )

    def tick(self, force=None, torque=None, **changes) -> LawOutput:
        i = self.healthy()
        if force is not None or torque is not None:
            f, t = force or (0.0, 0.0, 0.0), torque or (0.0, 0.0, 0.0)
            x, y, z = self.p.sensor_position
            moment = (t[0] - y * f[2] + z * f[1], t[1] - z * f[0] + x * f[2], t[2] - x * f[1] + y * f[0])
            changes["wrench"] = tuple(a + b for a, b in zip(i.wrench, (*f, *moment), strict=True))
        self.state, out = step(self.state, i._replace(**changes), self.p)
        self.k += 1
        return out

    def arm(self):
        """Release for one tick, then press with no force."""
        self.tick()
        return self.tick(travel=1.0)

    def run(self, ticks, **changes):
        return [self.tick(**changes) for _ in range(ticks)]


def speeds(outputs):
    return [sum(x * x for x in out.twist[:3]) ** 0.5 for out in outputs]


def changes_of(outputs):
    return [
        sum((b - a) ** 2 for a, b in zip(m.twist[:3], n.twist[:3], strict=True)) ** 0.5 for m, n in pairwise(outputs)
    ]
