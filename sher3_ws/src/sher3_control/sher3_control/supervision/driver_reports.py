"""What the supervisor reads from `/diagnostics`: stops of the motor driver, lost and overrun cycles of the nodes."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.reasons import Action, Reason

from sher3_control.supervision.detectors import Finding

ERROR = 2
"""Level of a diagnostic from which something is wrong (diagnostic_msgs)."""
DRIVES = "motor_driver: drives"
"""Name of the driver's diagnostic; its error level says that the driver has stopped the robot by itself."""
LOOP = frozenset(f"sher3/{node}" for node in ("motor_driver", "admittance", "kinematics", "force_sensor", "pedal"))
"""Names of the timing reports of the nodes in the control loop."""

Pairs = Sequence[tuple[str, str]]


def driver_stop(level: int, message: str, values: Pairs) -> Finding | None:
    """Return the stop that the driver reports, None when it reports none.

    A stop whose reason or numbers are not understood is still a stop: its reason is then DRIVE_EMERGENCY, its value 1.

    Args:
        level: of the diagnostic.
        message: its sentence.
        values: its pairs of key and value; `REASON stop [unit]` carries `VALUE limit LIMIT`.
    """
    if level < ERROR:
        return None
    report = dict(values)
    reason = Reason.__members__.get(report.get("reason", ""), Reason.DRIVE_EMERGENCY)
    harder = Action.__members__.get(report.get("action", ""), Action.NONE)
    source = f"motor_driver: {message}"
    stop = f"{reason.name} stop ["
    key, number = next(((key, text) for key, text in values if key.startswith(stop)), (f"{stop}1]", "1 limit 0"))
    value, _, limit = number.partition(" limit ")
    try:
        return Finding(reason, float(value), float(limit), key.split("[")[1].rstrip("]"), source, harder)
    except ValueError:
        return Finding(reason, 1.0, 0.0, "1", source, harder)


def cycle_counts(values: Pairs) -> tuple[int, int] | None:
    """Return the cycles that were due, and those lost or too long, of a timing report; None for another report."""
    report = dict(values)
    try:
        lost = int(report["lost_cycles"])
        return int(report["ticks"]) + lost, lost + int(report["overruns"])
    except (KeyError, ValueError):
        return None
