"""What the supervisor reads out of `/diagnostics`: the motor driver's stop, and the nodes' lost and overrun cycles."""

from __future__ import annotations

from collections.abc import Sequence

from .detectors import Finding
from .reasons import Action, Reason

ERROR = 2
DRIVES = "motor_driver: drives"
"""Name of the driver's own diagnostic; its error level says that the driver has stopped by itself."""
LOOP = frozenset(f"sher3/{node}" for node in ("motor_driver", "admittance", "kinematics", "force_sensor", "pedal"))
"""Names of the timing reports of the nodes in the control loop."""

Pairs = Sequence[tuple[str, str]]


def driver_stop(level: int, message: str, values: Pairs) -> Finding | None:
    """Return the stop a report of the driver tells of; a stop without a known reason still is one."""
    if level < ERROR:
        return None
    told = dict(values)
    reason = Reason.__members__.get(told.get("reason", ""), Reason.DRIVE_EMERGENCY)
    harder = Action.__members__.get(told.get("action", ""), Action.NONE)
    number = next((text for key, text in values if key.startswith(f"{reason.name} stop [")), "1 limit 0")
    unit = next((key.split("[")[1].rstrip("]") for key, _ in values if key.startswith(f"{reason.name} stop [")), "1")
    value, _, limit = number.partition(" limit ")
    try:
        return Finding(reason, float(value), float(limit), unit, f"motor_driver: {message}", harder)
    except ValueError:
        return Finding(reason, 1.0, 0.0, "1", f"motor_driver: {message}", harder)


def cycle_counts(values: Pairs) -> tuple[int, int] | None:
    """Return (cycles that were due, cycles lost or too long) of a timing report; None when it does not tell."""
    told = dict(values)
    try:
        lost = int(told["lost_cycles"])
        return int(told["ticks"]) + lost, lost + int(told["overruns"])
    except (KeyError, ValueError):
        return None
