"""Why the robot does not move, and how hard it is stopped: one code per cause, in every package and recording."""

from enum import IntEnum


class Reason(IntEnum):
    """Cause of zero velocity; MOVING says that there is none. The numbers are recorded, so they never change."""

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
    HAND_DOUBTFUL = 26
    FORCE_UNEXPLAINED = 27
    JOINTS_MISSING = 30
    JOINTS_STALE = 31
    JOINTS_NOT_FINITE = 32
    ENCODERS_DISAGREE = 33
    ENCODER_FROZEN = 34
    FOLLOWING_ERROR = 35
    LEG_SLIPPED = 36
    POSITION_LEFT = 37
    MOVED_DISABLED = 38
    FEEDBACK_STALE = 39
    FEEDBACK_SWAPPED = 43
    FEEDBACK_GARBLED = 44
    CLOCK = 40
    CPU_STARVED = 41
    OVERRUN = 42
    COMMAND_MISSING = 50
    COMMAND_STALE = 51
    COMMAND_NOT_FINITE = 52
    COMMAND_REFUSED = 53
    SINGULAR = 60
    OFF_CENTRE = 61
    TIP_SPEED = 62
    DRIVE_EMERGENCY = 70
    DRIVE_OVER_TEMPERATURE = 71
    DRIVE_SILENT = 72
    DRIVE_RESTARTED = 73
    DRIVE_FELL = 74
    DRIVE_STUCK = 75
    DRIVE_STATUSWORD = 76
    DRIVE_HOST_LOST = 77
    DRIVE_DISOBEYS = 78
    DRIVE_FAULT = 79
    BUS_OFF = 80
    BUS_PASSIVE = 81
    LINK_LOST = 82
    OTHER_HOST = 83
    DRIVE_TWICE = 84
    DRIVE_UNWILLING = 85
    SAFE_TORQUE_OFF = 86
    DRIVE_UNLIMITED = 87
    SUPERVISOR_SILENT = 90
    SUPERVISOR_FAULT = 91
    STOP_NOT_OBEYED = 92
    DRIVER_CLOSED = 93
    PUBLISHED_TWICE = 94


class Action(IntEnum):
    """How hard the robot is stopped, the most severe action last; of several the most severe one is taken.

    NONE: it is not stopped.
    ZERO: zero velocity in the same tick; the pedal must be released, then pressed, before the robot moves again.
    PAUSE: the operating state becomes PAUSED, and the drives hold their position.
    QUICK_STOP: the state becomes FAULT; the drives brake on their own ramp, then hold.
    POWER_OFF: the state becomes FAULT; the drives brake, and lose their power once they are at rest (stop category 1 of
    IEC 60204-1).
    """

    NONE = 0
    ZERO = 1
    PAUSE = 2
    QUICK_STOP = 3
    POWER_OFF = 4


_R = Reason

TEXT: dict[Reason, str] = {
    _R.MOVING: "motion is allowed",
    _R.PEDAL_RELEASED: "the pedal is released",
    _R.NOT_REARMED: "after a stop the pedal must be released, then pressed",
    _R.NOT_ENABLED: "the operating state is not ENABLED",
    _R.NOT_OWNER: "another motion mode owns the robot",
    _R.PEDAL_MISSING: "no pedal sample has arrived",
    _R.PEDAL_STALE: "the newest pedal sample is too old",
    _R.PEDAL_INVALID: "the pedal's message is not one travel from 0 to 1 with one button, its emergency stop",
    _R.EMERGENCY_STOP: "the emergency stop is pressed",
    _R.WRENCH_MISSING: "no wrench sample has arrived",
    _R.WRENCH_STALE: "the newest wrench sample is too old",
    _R.WRENCH_NOT_FINITE: "the wrench holds NaN or infinity",
    _R.WRENCH_OUT_OF_RANGE: "the wrench is beyond the range of the sensor",
    _R.WRENCH_SATURATED: "the force sensor is saturated",
    _R.WRENCH_FROZEN: "the wrench repeats bit for bit",
    _R.HAND_DOUBTFUL: "the force sensor feels a hand that the drives do not hold, or the other way round",
    _R.FORCE_UNEXPLAINED: "the force sensor reads more than the tool's weight and the tare explain",
    _R.JOINTS_MISSING: "no joint sample has arrived",
    _R.JOINTS_STALE: "the newest joint sample is too old",
    _R.JOINTS_NOT_FINITE: "the joint positions hold NaN or infinity",
    _R.ENCODERS_DISAGREE: "motor and load encoder of an axis moved apart",
    _R.ENCODER_FROZEN: "an encoder repeats bit for bit while the other one of its axis moves",
    _R.FOLLOWING_ERROR: "an axis does not follow its velocity demand",
    _R.LEG_SLIPPED: "the tracked tip and the load encoders disagree by the motion of one leg",
    _R.POSITION_LEFT: "an axis left the place that the commands sent to it add up to",
    _R.MOVED_DISABLED: "an axis moves though the robot is disabled",
    _R.FEEDBACK_STALE: "a drive's report is older than its tick",
    _R.FEEDBACK_SWAPPED: "a drive's report is that of another axis",
    _R.FEEDBACK_GARBLED: "a drive's report fails its check",
    _R.CLOCK: "time went backwards or jumped",
    _R.CPU_STARVED: "the control loop was held up",
    _R.OVERRUN: "the control loop overran its period too often",
    _R.COMMAND_MISSING: "the owner sends no command",
    _R.COMMAND_STALE: "the newest command is too old",
    _R.COMMAND_NOT_FINITE: "the command holds NaN or infinity",
    _R.COMMAND_REFUSED: "the motor driver refused too many commands",
    _R.SINGULAR: "the robot is singular here",
    _R.OFF_CENTRE: "the shaft has left the remote centre",
    _R.TIP_SPEED: "the tip would be faster than the speed cap in force",
    _R.DRIVE_EMERGENCY: "a drive reports an emergency",
    _R.DRIVE_OVER_TEMPERATURE: "a drive reports over-temperature",
    _R.DRIVE_SILENT: "a drive is silent",
    _R.DRIVE_RESTARTED: "a drive restarted or was stopped",
    _R.DRIVE_FELL: "a drive left OPERATION ENABLED by itself",
    _R.DRIVE_STUCK: "a drive does not change its state",
    _R.DRIVE_STATUSWORD: "a drive's statusword has no meaning",
    _R.DRIVE_HOST_LOST: "a drive lost the host's heartbeat",
    _R.DRIVE_DISOBEYS: "a drive does not execute the velocity it was sent",
    _R.DRIVE_FAULT: "a drive is in FAULT although nothing was to be recovered",
    _R.BUS_OFF: "a CAN controller is off the bus",
    _R.BUS_PASSIVE: "a CAN controller is error passive",
    _R.LINK_LOST: "a CAN link cannot be used",
    _R.OTHER_HOST: "another host speaks to the drives",
    _R.DRIVE_TWICE: "a drive speaks twice, or on a channel that is not its own",
    _R.DRIVE_UNWILLING: "a drive says that it does not do as it is told",
    _R.SAFE_TORQUE_OFF: "safe torque off has taken the torque from a motor",
    _R.DRIVE_UNLIMITED: "a drive does not have the speed limit of its regime",
    _R.SUPERVISOR_SILENT: "the supervisor is silent",
    _R.SUPERVISOR_FAULT: "the supervisor asked for the stop",
    _R.STOP_NOT_OBEYED: "an axis still moves after a quick stop",
    _R.DRIVER_CLOSED: "the motor driver was closed",
    _R.PUBLISHED_TWICE: "a stream of the robot's own has a second publisher",
}
"""The sentence of each code."""

ACTION: dict[Reason, Action] = {
    **dict.fromkeys(Reason, Action.QUICK_STOP),
    **dict.fromkeys((_R.PEDAL_RELEASED, _R.NOT_REARMED, _R.NOT_ENABLED, _R.NOT_OWNER), Action.ZERO),
    **dict.fromkeys((_R.SINGULAR, _R.OFF_CENTRE, _R.TIP_SPEED), Action.ZERO),
    _R.MOVING: Action.NONE,
    _R.OVERRUN: Action.PAUSE,
    **dict.fromkeys((_R.EMERGENCY_STOP, _R.DRIVE_OVER_TEMPERATURE, _R.STOP_NOT_OBEYED), Action.POWER_OFF),
    **dict.fromkeys((_R.ENCODERS_DISAGREE, _R.ENCODER_FROZEN, _R.FOLLOWING_ERROR, _R.DRIVE_DISOBEYS), Action.POWER_OFF),
    **dict.fromkeys((_R.POSITION_LEFT, _R.MOVED_DISABLED), Action.POWER_OFF),
    **dict.fromkeys((_R.OTHER_HOST, _R.SAFE_TORQUE_OFF), Action.POWER_OFF),
}
"""What the supervisor or the motor driver does for each reason; the control law itself answers every one with ZERO."""


def reading(reason: Reason, source: str, value: float, limit: float, unit: str) -> tuple[str, str]:
    """Return the number that a detector looks at as a pair of key and value for `/diagnostics`.

    Args:
        reason: which the detector would give.
        source: stream or component.
        value: the number.
        limit: its limit.
        unit: of both.
    """
    return f"{reason.name} {source} [{unit}]", f"{value:.6g} limit {limit:.6g}"
