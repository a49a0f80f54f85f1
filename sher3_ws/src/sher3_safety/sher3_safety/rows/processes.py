"""The cases in wall time: each process killed or held while the robot moves, and a machine with too much to do."""

from __future__ import annotations

from sher3_safety.rows.row import IDLE, LIMIT, MOVING, Row

WALL_STATES = (IDLE, MOVING, LIMIT)
HOG = "cpu"
"""Component of the processes that take the processor away."""
RECORDING = "motion does not hang on the second recorder of a run; its bag can be recovered"
WORLD = (
    "the emulated drives, sensor, pedal and tip end with the process, so nothing moves and nothing is measured; "
    "asserted: the first report within 50 ms, and FAULT within 100 ms, for the drives or for the pedal that fell silent"
)
BUSY = "busy processes of ordinary priority, begun while the robot moves; it goes on, or it stops within the budget"
ALIKE = "the robot's processes have no other priority"
NODES = ("motor_driver", "admittance", "supervisor", "kinematics", "force_sensor", "pedal")

WALL = (
    *(Row(f"process.{name}", "off", quick=name in ("motor_driver", "supervisor")) for name in NODES),
    Row("process.recorder", "off", expects="goes on", why=RECORDING),
    Row("process.plant", "off", expects="ends", reasons=("DRIVE_SILENT", "EMERGENCY_STOP"), why=WORLD),
    *(Row(f"process.{name}", "stuck", quick=name == "motor_driver") for name in NODES),
    *(Row(HOG, "slow", {"processes": count}, expects="either", why=BUSY) for count in (1.0, 2.0, 8.0)),
    *(
        Row(HOG, "slow", {"processes": count, "realtime": 0.0}, expects="either", why=f"{BUSY}; {ALIKE}")
        for count in (1.0, 2.0)
    ),
)
