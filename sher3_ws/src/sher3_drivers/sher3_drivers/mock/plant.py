"""The smallest plant for the mock drives: five ideal integrators, for tests and benches of the drivers."""

from __future__ import annotations

from typing import NamedTuple

from sher3_description import ACTUATORS, Robot


class IntegratorReading(NamedTuple):
    """Readings of an ideal plant, (5,) each."""

    motor_position: list[float]
    load_position: list[float]
    demand: list[float]
    effort: list[float]


class IntegratorPlant:
    """A position that is the integral of the demand, without dynamics and effort.

    Attributes:
        position: exact positions (5,), m and rad.
    """

    def __init__(self, robot: Robot, period: float) -> None:
        self.position = [0.0] * len(ACTUATORS)
        self._period = period
        self._resolutions = [(a.motor_encoder, a.load_encoder) for a in robot.actuators]

    def step(self, velocity_command: list[float]) -> IntegratorReading:
        """Integrate one period and return the encoder readings."""
        self.position = [q + self._period * v for q, v in zip(self.position, velocity_command, strict=True)]
        motor = [round(q / m) * m for q, (m, _) in zip(self.position, self._resolutions, strict=True)]
        load = [round(q / n) * n for q, (_, n) in zip(self.position, self._resolutions, strict=True)]
        return IntegratorReading(motor, load, list(velocity_command), [0.0] * len(load))
