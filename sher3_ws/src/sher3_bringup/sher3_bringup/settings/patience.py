"""Time limits of a run: strict for the robot, patient for mocks on a machine that others use too.

An ordinary computer holds a process up for 10 to 150 ms now and then. At the robot that is a stop, as it must be: the
tip travels 0.5 mm in 100 ms. On mocks nothing can be hurt, and a demonstration that ends there shows nothing; so its
limits are longer than the pauses of such a machine. The longer limits are written here and nowhere else, and recorded
with the settings of each run; limits other than times stay as they are.
"""

from __future__ import annotations

from typing import Any, Literal

from sher3_control.motion.speed_cap import Regime, axis_caps, speed_cap
from sher3_control.settings import MotionSettings
from sher3_description import Robot
from sher3_drivers.settings import MotorDriverSettings

Patience = Literal["strict", "patient"]
"""`strict`: the limits that the settings of drivers and control declare. `patient`: those below; mocks only."""

CONTROL: dict[str, Any] = {
    "wrench": {"age_limit": 0.4},
    "pedal": {"age_limit": 0.4},
    "admittance": {"joints_age_limit": 0.4, "lead_limit": 0.4},
    "motion": {"servo_timeout": 0.4, "joints_age_limit": 0.4, "lead_limit": 0.4},
    "supervisor": {"stream_age_limit": 0.6, "heartbeat_limit": 0.6, "overrun_share": 1.0},
}
"""Overrides of `ControlSettings` [s]; strict: 0.010 to 0.020, lead 0, 0.1 and 0.03 for the supervisor, overruns 0.1."""

DRIVES: dict[str, Any] = {
    "host_heartbeat_limit": 0.6,
    "drive_heartbeat_limit": 1.0,
    "missing_limit": 200,
    "report_limit": 200,
    "stop_age": 300,
    "transition_limit": 2.0,
    "supervisor_limit": 0.6,
    "stall_limit": 0.5,
}
"""Overrides of `MotorDriverSettings` [s; ticks]; strict: 0.027, 0.2, 6, 3, 50, 0.5, 0.03, 0.02.

Reports of a drive that was held up come late and fail their check: they are dropped, as missing ones are. Zero velocity
is still sent to the drives once a command is `zero_age` ticks old, and motion goes on with the next command."""

BENCH: dict[str, Any] = {
    "encoder_distance": 5e-4,
    "encoder_angle": 2e-2,
    "echo_reports": 100_000,
    "encoder_drift_distance": 5e-3,
    "encoder_drift_angle": 0.1,
    "encoder_total_distance": 5e-3,
    "encoder_total_angle": 0.1,
    "following_distance": 1e-3,
    "following_angle": 5e-2,
    "obey_distance": 1e-3,
    "obey_angle": 5e-2,
    "obey_latency": 0.1,
    "position_distance": 5e-3,
    "position_angle": 0.1,
    "position_lag": 0.1,
    "rest_distance": 2e-4,
    "rest_angle": 1e-2,
}
"""Overrides of `MotorDriverSettings` on the bench [m, rad, s]: a robot whose gap is to be measured there has backlash,
lag and wrong scales, and must not be stopped for them; strict: 7 um, 0.4 mrad, 60 um. They are no time limits, and near
a patient there is no bench."""


def usual(mock: bool, regime: str, realtime: int) -> Patience:
    """Return the limits of a run that names none: strict but on a bench of mocks without real-time rights.

    Without these rights (`realtime` 0) nothing bounds for how long the kernel holds a process up, and strict limits
    then stop a robot that is well. In a regime with a travel budget, and on the robot, they stay strict all the same.
    """
    return "patient" if mock and not realtime and regime in ("", "bench") else "strict"


def drives_in(robot: Robot, motion: MotionSettings, drives: MotorDriverSettings) -> MotorDriverSettings:
    """Return the motor driver's settings for the speed regimes of `motion`: their caps, and on the bench its limits."""
    limits = [actuator.limits.velocity for actuator in robot.actuators]
    caps = [
        {"regime": regime.value, "caps": axis_caps(motion, speed_cap(motion, regime), limits)}
        for regime in (Regime.NEAR_TISSUE, Regime.FREE)
    ]
    bench = BENCH if motion.regime == Regime.BENCH.value else {}
    return MotorDriverSettings.checked(**{**drives.model_dump(), "regime": motion.regime, "caps": caps, **bench})


PEDAL_AGE = {"strict": 0.02, "patient": 0.6}
"""Longest silence of the mock pedal [s]."""
