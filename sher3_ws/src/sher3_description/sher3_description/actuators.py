"""The names of the actuators, in the order of every joint vector."""

from typing import Literal

ActuatorName = Literal["delta_1", "delta_2", "delta_3", "roll", "tilt"]
ACTUATORS: tuple[str, ...] = ("delta_1", "delta_2", "delta_3", "roll", "tilt")
"""Sliders of the three legs of the delta, rotation of the arm, slider of the tilt linkage."""
