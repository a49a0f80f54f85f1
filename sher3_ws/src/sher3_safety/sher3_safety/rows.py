"""The rows of the matrix: every component with every kind of fault that it can have, and what must come of it."""

from __future__ import annotations

from sher3_description import ACTUATORS

from .matrix import Row

AXIS, LAST = ACTUATORS[0], ACTUATORS[-1]
CURRENT = "the newest sample in time is the one that counts"
HELD = "a younger sample comes within the age limit; the last one is held until then"
NO_WITNESS = "one channel, no second witness: "

FORCE = (
    Row("force_sensor", "off", reasons=("WRENCH_STALE",), quick=True),
    Row("force_sensor", "stuck", reasons=("WRENCH_FROZEN",), quick=True),
    Row("force_sensor", "garbage", reasons=("WRENCH_OUT_OF_RANGE",), quick=True),
    Row("force_sensor", "wrong", {"offset": 20.0}, reasons=("WRENCH_OUT_OF_RANGE", "WRENCH_SATURATED"), quick=True),
    Row("force_sensor", "wrong", {"code": 1.0}, reasons=("WRENCH_NOT_FINITE",), quick=True),
    Row("force_sensor", "wrong", {"scale": 1.5}, effect="either", why=NO_WITNESS + "speed stays under the cap"),
    Row("force_sensor", "slow", {"every": 4.0}, effect="goes on", why=HELD),
    Row("force_sensor", "slow", {"every": 20.0}, reasons=("WRENCH_STALE",)),
    Row("force_sensor", "delayed", {"delay": 0.1}, reasons=("WRENCH_STALE",), duration=0.25),
    Row("force_sensor", "delayed", {"delay": 0.004}, effect="goes on", why=HELD),
    Row("force_sensor", "intermittent", effect="either", why=HELD),
    Row("force_sensor", "duplicated", effect="goes on", why=CURRENT, quick=True),
    Row("force_sensor", "reordered", effect="goes on", why=CURRENT),
)
PEDAL = (
    Row("pedal", "off", reasons=("EMERGENCY_STOP", "PEDAL_INVALID"), quick=True),
    Row("pedal", "stuck", effect="goes on"),
    Row("pedal", "garbage", reasons=("EMERGENCY_STOP", "PEDAL_INVALID"), quick=True),
    Row("pedal", "wrong", {"offset": 2.0}, reasons=("EMERGENCY_STOP", "PEDAL_INVALID")),
    Row("pedal", "slow", {"every": 4.0}, effect="goes on", why=HELD),
    Row("pedal", "slow", {"every": 20.0}, reasons=("EMERGENCY_STOP",)),
    Row("pedal", "delayed", {"delay": 0.1}, reasons=("EMERGENCY_STOP",), duration=0.25),
    Row("pedal", "delayed", {"delay": 0.01}, effect="goes on", why=HELD),
    Row("pedal", "intermittent", effect="either", why=HELD),
    Row("pedal", "duplicated", effect="goes on", why=CURRENT),
    Row("pedal", "reordered", effect="goes on", why=CURRENT),
)
LINE = tuple(
    Row(component, fault)
    for component in ("bus", "bus0.up", "bus1.down", AXIS, f"{AXIS}.up", f"{AXIS}.down")
    for fault in ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "duplicated", "reordered")
)
ENCODERS = tuple(
    Row(f"{AXIS}.{part}", fault, {"offset": 1e-3} if fault == "wrong" else {})
    for part in ("load_encoder", "motor_encoder")
    for fault in ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "duplicated", "reordered")
)
DEMAND = tuple(
    Row(f"{AXIS}.demand", fault, {"scale": -1.0} if fault == "wrong" else {})
    for fault in ("stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "reordered")
) + (
    Row(f"{AXIS}.demand", "wrong", {"code": float(0x4210)}),
    Row(f"{AXIS}.demand", "wrong", {"scale": 0.0}),
    Row(f"{AXIS}.demand", "wrong", {"scale": 2.0}),
)
PROCESSES = tuple(
    Row(f"process.{name}", fault)
    for name in ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor")
    for fault in ("stuck", "off")
)
CLOCK = tuple(
    Row(f"clock{part}", "wrong", {"offset": offset})
    for part in ("", ".force_sensor", ".pedal", ".motor_driver")
    for offset in (0.05, -0.05)
)
ROWS = FORCE + PEDAL + LINE + ENCODERS + DEMAND + PROCESSES + CLOCK
