"""The cases in wall time: each process killed or held while the robot moves, and a machine with too much to do."""

from __future__ import annotations

from .matrix import Row

HOG = "cpu"
"""Component of the processes that take the processor away."""
RECORDING = "motion does not hang on the second recorder of a run; its bag can be recovered"
WORLD = "with the plant the devices of the mock end: the last recorded travel"

WALL = (
    Row("process.motor_driver", "off", quick=True),
    Row("process.admittance", "off"),
    Row("process.supervisor", "off", quick=True),
    Row("process.kinematics", "off"),
    Row("process.force_sensor", "off"),
    Row("process.pedal", "off"),
    Row("process.recorder", "off", effect="goes on", why=RECORDING),
    Row("process.plant", "off", why=WORLD),
    Row("process.motor_driver", "stuck"),
    Row("process.admittance", "stuck"),
    Row("process.supervisor", "stuck"),
    Row("process.kinematics", "stuck"),
    Row("process.force_sensor", "stuck"),
    Row("process.pedal", "stuck"),
    Row(HOG, "slow", {"processes": 8.0}, effect="either", why="without real-time priority; 8 busy processes"),
)
