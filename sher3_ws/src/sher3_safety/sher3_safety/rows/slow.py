"""The slow faults: axes that creep behind a truthful look, encoders that drift, reports that are late."""

from __future__ import annotations

from sher3_description import ACTUATORS

from sher3_safety.rows.row import LIMIT, PAUSED, SIDEWAYS, STATES, STILL, Row

AXIS, ROLL, TILT = ACTUATORS[0], ACTUATORS[3], ACTUATORS[4]
LEFT = ("POSITION_LEFT",)
ALL = (*STATES, PAUSED)
CREEPS = (1e-5, 1e-4, 1e-3)
"""Speeds of a creeping slider [m/s], a decade apart; the slowest takes 0.7 s to its limit of 7 um."""
LONGEST = 1.5
"""Duration of the slowest ones [s]: twice the time to the limit."""
FAST = (LIMIT.name,)
"""At 5 mm/s the limit is 43 um, which a slow creep does not reach in that time."""
TURNED = ("HAND_DOUBTFUL",)
"""The torque that starts a roll of 0.1 rad/s within a tick is told by its drive, and the force sensor feels none of it:
one or the other watch comes first, within the same 4 ms."""
AT_ITS_LIMIT = "one period at the drive's own speed limit is 24 um at a leg, and it brakes from there"
STATED = "in the middle of the travel a scale changes nothing; elsewhere the encoders part"

SLOW = (
    *(
        Row(f"{name}.power", "creep", {"speed": sign * speed}, reasons=LEFT, slow=True, quiet=FAST,
            duration=min(LONGEST, max(0.12, 2e-5 / speed)), states=ALL, quick=name == AXIS and speed == CREEPS[1])
        for name, sign in ((AXIS, 1.0), (ACTUATORS[1], -1.0), (ACTUATORS[2], 1.0), (TILT, -1.0))
        for speed in CREEPS
    ),
    *(
        Row(f"{ROLL}.power", "creep", {"speed": speed}, reasons=(*LEFT, *told), slow=True, quiet=FAST,
            duration=min(LONGEST, 1e-3 / speed), states=ALL)
        for speed, told in ((1e-3, ()), (1e-2, ()), (1e-1, TURNED))
    ),
    *(
        Row(f"{name}.demand", "creep", {"speed": speed}, reasons=(*LEFT, "DRIVE_DISOBEYS"), slow=True, quiet=FAST,
            duration=min(LONGEST, 2e-5 / speed if name != ROLL else 1e-3 / speed), states=ALL)
        for name, speed in ((AXIS, 2e-5), (AXIS, 1e-3), (TILT, 2e-5), (TILT, 1e-3), (ROLL, 1e-3), (ROLL, 1e-1))
    ),
    Row(f"{AXIS}.power", "creep", {"speed": 0.0122}, slow=True, budget=250e-6, why=AT_ITS_LIMIT),
    *(Row(f"{name}.load_encoder", "drift", {"rate": 2e-5}, slow=True, duration=LONGEST) for name in (AXIS, TILT)),
    Row(f"{ROLL}.load_encoder", "drift", {"rate": 1e-3}, slow=True, duration=LONGEST),
    Row(f"{AXIS}.motor_encoder", "drift", {"rate": 2e-5}, slow=True, duration=LONGEST),
    Row(f"{AXIS}.motor_encoder", "ramp", {"rate": 0.5}, slow=True, expects="either", why=STATED),
    *(Row("bus.up", "late", {"items": age}, reasons=("FEEDBACK_STALE",)) for age in (1.0, 3.0)),
    Row("bus0.up", "swap", reasons=("FEEDBACK_SWAPPED",), states=(*STATES, SIDEWAYS), quick=True),
    Row(f"{AXIS}.echo", "wrong", {"scale": 0.0}, reasons=("DRIVE_DISOBEYS",), quiet=STILL),
    Row(f"{AXIS}.echo", "stuck", release=True),
)  # fmt: skip
