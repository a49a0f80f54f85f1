"""What the user does about each cause that the robot stops for: the second half of the sentence in `reasons.TEXT`."""

from __future__ import annotations

from sher3_common.reasons import Reason

_R = Reason
_WIRE = "look at the sensor's cable and power"
_ENCODER = "do not move this axis; check its encoder, coupling and cable"
_BUS = "check the CAN cable, its ends and the adapter"
_UNHEARD = f"{_BUS}; on mocks end other work on this computer, or start with `--layout composed`"
_DRIVE = "read the drive's own error code; switch the drives off and on"
_BUSY = "stop other work on this computer, or give real-time priority; on mocks `--patient`"
_SILENT = "the node that sends it has ended or is held up; see its lines above"

REMEDY: dict[Reason, str] = {
    _R.MOVING: "nothing is to be done",
    _R.PEDAL_RELEASED: "press the pedal",
    _R.NOT_REARMED: "release the pedal, then press it",
    _R.NOT_ENABLED: "send enable",
    _R.NOT_OWNER: "wait until the other mode ends, or send disable",
    _R.PEDAL_MISSING: "start the pedal's node, or publish pedal/measured",
    _R.PEDAL_STALE: "the pedal's sender fell silent or slowed down; see that it sends at its rate",
    _R.PEDAL_INVALID: "send a Joy of one axis, the travel, and one button, 1 while the emergency stop is pressed",
    _R.EMERGENCY_STOP: "release the emergency stop",
    _R.WRENCH_MISSING: "start the force sensor's node, or publish force/measured_cf",
    _R.WRENCH_STALE: "the force sensor's sender fell silent or slowed down; see that it sends at the control rate",
    _R.WRENCH_NOT_FINITE: _WIRE,
    _R.WRENCH_OUT_OF_RANGE: _WIRE,
    _R.WRENCH_SATURATED: "let go of the tool; check what presses on the sensor",
    _R.WRENCH_FROZEN: "a real sensor has noise: check its cable, or add noise to what you publish",
    _R.HAND_DOUBTFUL: "let go of the tool; tare; check force sensor, drives and what else touches the robot",
    _R.FORCE_UNEXPLAINED: "let go of the tool and send enable; if nothing touches it, tare with the tool hanging free",
    _R.JOINTS_MISSING: "start the motor driver",
    _R.JOINTS_STALE: "the motor driver fell silent or slowed down; see its lines above",
    _R.JOINTS_NOT_FINITE: _ENCODER,
    _R.ENCODERS_DISAGREE: _ENCODER,
    _R.ENCODER_FROZEN: _ENCODER,
    _R.FOLLOWING_ERROR: "look for what blocks the axis, and at its drive",
    _R.LEG_SLIPPED: "check the legs' joints and their calibration",
    _R.POSITION_LEFT: "look for what pushed the axis, and at its drive",
    _R.MOVED_DISABLED: "look for what moved the axis, and at its brake",
    _R.FEEDBACK_STALE: _UNHEARD,
    _R.FEEDBACK_SWAPPED: "check the drives' node ids and channels",
    _R.FEEDBACK_GARBLED: _BUS,
    _R.CLOCK: "let the clock of this computer be slewed and never stepped",
    _R.CPU_STARVED: _BUSY,
    _R.OVERRUN: _BUSY,
    _R.COMMAND_MISSING: "start who sends the command, or send disable",
    _R.COMMAND_STALE: "send the command at the control rate, stamped with the system time",
    _R.COMMAND_NOT_FINITE: "send finite numbers",
    _R.COMMAND_REFUSED: "see in the driver's diagnostics why they were refused",
    _R.SINGULAR: "move away from here axis by axis (servo_jv)",
    _R.OFF_CENTRE: "bring the shaft back, or set the remote centre anew",
    _R.TIP_SPEED: "push less, send a slower command, or choose another regime",
    _R.DRIVE_EMERGENCY: _DRIVE,
    _R.DRIVE_OVER_TEMPERATURE: "let the drives cool down",
    _R.DRIVE_SILENT: _UNHEARD,
    _R.DRIVE_RESTARTED: _DRIVE,
    _R.DRIVE_FELL: _DRIVE,
    _R.DRIVE_STUCK: _DRIVE,
    _R.DRIVE_STATUSWORD: _DRIVE,
    _R.DRIVE_HOST_LOST: _BUSY,
    _R.DRIVE_DISOBEYS: _DRIVE,
    _R.DRIVE_FAULT: _DRIVE,
    _R.BUS_OFF: _BUS,
    _R.BUS_PASSIVE: _BUS,
    _R.LINK_LOST: _BUS,
    _R.OTHER_HOST: "find the other host on the CAN bus and unplug it",
    _R.DRIVE_TWICE: "check the drives' node ids and channels",
    _R.DRIVE_UNWILLING: _DRIVE,
    _R.SAFE_TORQUE_OFF: "close the safety circuit",
    _R.DRIVE_UNLIMITED: "start the robot again, so that the drives are set up anew",
    _R.SUPERVISOR_SILENT: _SILENT,
    _R.SUPERVISOR_FAULT: "see the supervisor's own reason",
    _R.STOP_NOT_OBEYED: "switch the drives off; do not go on before the reason is known",
    _R.DRIVER_CLOSED: "start the motor driver again",
    _R.PUBLISHED_TWICE: "end one of the two",
}
"""What to do about each reason; a clause without a full stop."""
INSTEAD: dict[str, str] = {
    "pedal/measured": "to send your own, start the robot with `--without pedal`, or publish mock/pedal on mocks",
    "force/measured_cf": "to send your own, start the robot with `--without force_sensor`, or publish "
    "mock/contact_wrench on mocks",
    "servo_cv": "a tip twist of your own is the command servo_cv",
    "servo_jv": "actuator velocities of your own are the command servo_jv",
}
"""Where a sample of the user's own goes, by the stream that has a second publisher."""
RECOVER = "then send disable, and enable"
"""How FAULT is left when its cause is gone."""


def remedy(reason: Reason, source: str = "") -> str:
    """Return what to do about a reason; of a stream with two publishers, what to publish or to start instead."""
    if reason is Reason.PUBLISHED_TWICE and source in INSTEAD:
        return f"end one of the two; {INSTEAD[source]}"
    return REMEDY[reason]
