"""Why the robot does not move: one code per cause, for the law, the modes, the supervisor and the recordings alike."""

from enum import IntEnum


class Reason(IntEnum):
    """Cause of zero velocity; `MOVING` means there is none. The numbers are recorded, so they never change."""

    MOVING = 0
    PEDAL_RELEASED = 1
    NOT_REARMED = 2
    NOT_ENABLED = 3
    NOT_OWNER = 4
    PEDAL_MISSING = 10
    PEDAL_STALE = 11
    PEDAL_INVALID = 12
    EMERGENCY_STOP = 13
    WRENCH_MISSING = 20
    WRENCH_STALE = 21
    WRENCH_NOT_FINITE = 22
    WRENCH_OUT_OF_RANGE = 23
    WRENCH_SATURATED = 24
    WRENCH_FROZEN = 25
    JOINTS_MISSING = 30
    JOINTS_STALE = 31
    JOINTS_NOT_FINITE = 32
    CLOCK = 40
    COMMAND_MISSING = 50
    COMMAND_STALE = 51
    COMMAND_NOT_FINITE = 52
    SINGULAR = 60
    OFF_CENTRE = 61


TEXT: dict[Reason, str] = {
    Reason.MOVING: "motion is allowed",
    Reason.PEDAL_RELEASED: "the pedal is released",
    Reason.NOT_REARMED: "after a stop the pedal must be released, then pressed",
    Reason.NOT_ENABLED: "the operating state is not ENABLED",
    Reason.NOT_OWNER: "another motion mode owns the robot",
    Reason.PEDAL_MISSING: "no pedal sample has arrived",
    Reason.PEDAL_STALE: "the newest pedal sample is too old",
    Reason.PEDAL_INVALID: "the pedal travel is not a number from 0 to 1",
    Reason.EMERGENCY_STOP: "the emergency stop is pressed",
    Reason.WRENCH_MISSING: "no wrench sample has arrived",
    Reason.WRENCH_STALE: "the newest wrench sample is too old",
    Reason.WRENCH_NOT_FINITE: "the wrench holds NaN or infinity",
    Reason.WRENCH_OUT_OF_RANGE: "the wrench is beyond the range of the sensor",
    Reason.WRENCH_SATURATED: "the force sensor is saturated",
    Reason.WRENCH_FROZEN: "the wrench repeats bit for bit",
    Reason.JOINTS_MISSING: "no joint sample has arrived",
    Reason.JOINTS_STALE: "the newest joint sample is too old",
    Reason.JOINTS_NOT_FINITE: "the joint positions hold NaN or infinity",
    Reason.CLOCK: "time went backwards or jumped",
    Reason.COMMAND_MISSING: "the owner sends no command",
    Reason.COMMAND_STALE: "the newest command is too old",
    Reason.COMMAND_NOT_FINITE: "the command holds NaN or infinity",
    Reason.SINGULAR: "the robot is singular here",
    Reason.OFF_CENTRE: "the shaft has left the remote centre",
}
