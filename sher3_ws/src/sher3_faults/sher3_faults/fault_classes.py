"""What may break, the longest time until it is noticed, and how the robot then stops: from the settings alone.

Every time is the longest possible one. An age limit is noticed at the first tick after it, and that tick may wait for
its samples until the next one is due: two control periods are added to every age limit. A limit that counts ticks
takes one tick more.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from sher3_common.reasons import Reason
from sher3_control.settings import ControlSettings
from sher3_drivers.sensor.health import SensorLimits
from sher3_drivers.settings import MotorDriverSettings


class FaultClass(NamedTuple):
    """One way to break.

    Attributes:
        fault: the part that breaks.
        reason: code with which it is noticed first.
        detection: longest time from the fault to the first command that answers it [s].
        stop: `zero` demand, or the drives' own `ramp`.
        setting: what the time follows from, and what to shorten.
        apart: what may part before it is noticed: motor and load encoder, or an axis and the sum of its commands.
    """

    fault: str
    reason: Reason
    detection: float
    stop: Literal["zero", "ramp"]
    setting: str
    apart: Literal["", "encoders", "position"] = ""


def fault_classes(control: ControlSettings, drives: MotorDriverSettings) -> list[FaultClass]:
    """Return every class whose travel the speed cap bounds; a drive that ignores its commands is not among them."""
    period = drives.period
    late = 2.0 * period
    motion, wrench, pedal = control.motion, control.wrench, control.pedal
    drives_alone = drives.host_heartbeat_limit + late
    stalled = max(drives.stall_limit, drives.host_heartbeat_limit) + late
    frozen = wrench.frozen_samples * period + late
    jumping = 2.0 * SensorLimits._field_defaults["jumps"] * period + late
    user = motion.servo_timeout + late
    r, heartbeat = Reason, "drives.host_heartbeat_limit"
    return [
        FaultClass("pedal released", r.PEDAL_RELEASED, late, "zero", "control period"),
        FaultClass("emergency stop pressed", r.EMERGENCY_STOP, late, "zero", "control period"),
        FaultClass("pedal silent or dead", r.PEDAL_STALE, pedal.age_limit + late, "zero", "pedal.age_limit"),
        FaultClass("force sensor silent, dead", r.WRENCH_STALE, wrench.age_limit + late, "zero", "wrench.age_limit"),
        FaultClass("force sensor frozen", r.WRENCH_FROZEN, frozen, "zero", "wrench.frozen_samples"),
        FaultClass("force not finite, out of range", r.WRENCH_NOT_FINITE, late, "zero", "control period"),
        FaultClass("force to and fro every other tick", r.WRENCH_NOT_FINITE, jumping, "zero", "SensorLimits.jumps"),
        FaultClass(
            "joint positions silent", r.JOINTS_STALE, motion.joints_age_limit + late, "zero", "motion.joints_age_limit"
        ),
        FaultClass(
            "admittance node dead", r.COMMAND_STALE, motion.joints_age_limit + late, "zero",
            "motion.joints_age_limit",
        ),
        FaultClass("user's commands silent", r.COMMAND_STALE, user, "zero", "motion.servo_timeout"),
        FaultClass(
            "kinematics node dead", r.COMMAND_STALE, (drives.zero_age + 1) * period, "zero", "drives.zero_age"
        ),
        FaultClass("clock jumped", r.CLOCK, wrench.age_limit + late, "zero", "wrench.age_limit"),
        FaultClass(
            "supervisor dead", r.SUPERVISOR_SILENT, drives.supervisor_limit + late, "ramp", "drives.supervisor_limit"
        ),
        FaultClass(
            "fault known to the supervisor", r.SUPERVISOR_FAULT, control.supervisor.heartbeat_period + late, "ramp",
            "supervisor.heartbeat_period",
        ),
        FaultClass("motor driver or computer dead", r.DRIVE_HOST_LOST, drives_alone, "ramp", heartbeat),
        FaultClass("motor driver held up", r.CPU_STARVED, stalled, "ramp", heartbeat),
        FaultClass("CAN bus off or cut", r.BUS_OFF, drives_alone, "ramp", heartbeat),
        FaultClass("drive reports a fault or restarts", r.DRIVE_EMERGENCY, late, "ramp", "control period"),
        FaultClass("drive silent", r.DRIVE_SILENT, motion.joints_age_limit + late, "zero", "motion.joints_age_limit"),
        FaultClass(
            "encoder wrong, coupling slips", r.ENCODERS_DISAGREE, drives.encoder_latency + late, "ramp",
            "drives.encoder_distance or encoder_latency", "encoders",
        ),
        FaultClass("encoder frozen", r.ENCODER_FROZEN, late, "ramp", "drives.encoder_distance", "encoders"),
        FaultClass("axis leaves its commands", r.POSITION_LEFT, late, "ramp", "drives.position_distance", "position"),
    ]  # fmt: skip
