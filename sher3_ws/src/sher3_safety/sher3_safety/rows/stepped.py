"""The rows of the matrix: every component with every kind of fault that it can have, and what must come of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from sher3_bringup.settings.run_settings import LOOP
from sher3_description import ACTUATORS

from sher3_safety.rows.row import IDLE, STILL, Row
from sher3_safety.rows.several import SEVERAL
from sher3_safety.rows.slow import SLOW
from sher3_safety.rows.together import TOGETHER
from sher3_safety.rows.wiring import WIRING

AXIS = ACTUATORS[0]
CURRENT = "the newest sample in time is the one that counts"
HELD = "a younger sample comes within the age limit; the last one is held until then"
SAME = "the command does not change, so nothing is lost with it; see the line with the pedal released"
NO_WITNESS = "one channel, no second witness; the tip stays under the speed cap of its regime"
STUCK_PEDAL = (
    "travel and both contacts at once, as when the lever itself hangs: it looks like a foot that stays; the hand still"
    " decides (no force, no motion), and no press counts for longer than 120 s"
)
AT_ONCE = "the drive's own limit, 12.2 mm/s, makes 24 um in the tick before its echo can tell"
GARBLED = 250e-6
STALE = ("WRENCH_STALE",)
NO_PEDAL = ("EMERGENCY_STOP", "PEDAL_INVALID", "PEDAL_STALE")
LINE_LOST = ("JOINTS_STALE", "DRIVE_SILENT", "DRIVE_HOST_LOST")

FORCE = (
    Row("force_sensor", "off", reasons=STALE, quick=True),
    Row("force_sensor", "stuck", reasons=("WRENCH_FROZEN",), quick=True),
    Row("force_sensor", "garbage", reasons=("WRENCH_OUT_OF_RANGE",)),
    Row("force_sensor", "wrong", {"offset": 20.0}, reasons=("WRENCH_OUT_OF_RANGE", "WRENCH_SATURATED")),
    Row("force_sensor", "wrong", {"code": 1.0}, reasons=("WRENCH_NOT_FINITE",)),
    Row("force_sensor", "wrong", {"scale": 0.8}, expects="either", why=NO_WITNESS),
    Row("force_sensor", "slow", {"every": 4.0}, expects="goes on", why=HELD),
    Row("force_sensor", "slow", {"every": 20.0}, reasons=STALE),
    Row("force_sensor", "delayed", {"delay": 0.1}, reasons=STALE, duration=0.25),
    Row("force_sensor", "delayed", {"delay": 0.004}, expects="goes on", why=HELD),
    Row("force_sensor", "intermittent", expects="either", why=HELD),
    Row("force_sensor", "duplicated", expects="goes on", why=CURRENT, quick=True),
    Row("force_sensor", "reordered", expects="goes on", why=CURRENT),
)
PEDAL = (
    Row("pedal", "off", reasons=NO_PEDAL, quick=True),
    Row("pedal", "off", release=True),
    Row("pedal", "stuck", expects="residual", release=True, why=STUCK_PEDAL),
    Row("pedal", "garbage", reasons=NO_PEDAL, quick=True),
    Row("pedal", "wrong", {"offset": 2.0}, reasons=NO_PEDAL),
    Row("pedal", "slow", {"every": 4.0}, expects="goes on", why=HELD),
    Row("pedal", "slow", {"every": 4.0}, release=True),
    Row("pedal", "slow", {"every": 20.0}, reasons=NO_PEDAL),
    Row("pedal", "delayed", {"delay": 0.1}, reasons=NO_PEDAL, duration=0.25),
    Row("pedal", "delayed", {"delay": 0.01}, expects="goes on", why=HELD),
    Row("pedal", "delayed", {"delay": 0.02}, release=True),
    Row("pedal", "intermittent", expects="either", why=HELD),
    Row("pedal", "intermittent", release=True),
    Row("pedal", "duplicated", expects="goes on", why=CURRENT),
    Row("pedal", "reordered", release=True),
    Row("pedal.travel", "stuck", release=True, quick=True),
    Row("pedal.contact", "stuck", release=True),
    Row("pedal.contact", "wrong", {"scale": 0.0}, quiet=(IDLE.name,)),
)


def _up(line: str, silent: tuple[str, ...] = LINE_LOST, quick: bool = False) -> Iterator[Row]:
    """Yield the faults of what the drives say; `silent` is what is said where they say nothing."""
    yield Row(line, "off", reasons=silent, quick=quick)
    yield Row(line, "stuck", quiet=STILL)
    yield Row(line, "garbage", reasons=("FEEDBACK_GARBLED",))
    yield Row(line, "wrong", quick=quick)
    yield Row(line, "slow", {"every": 4.0}, expects="either", why=HELD)
    yield Row(line, "slow", {"every": 20.0}, reasons=LINE_LOST)
    yield Row(line, "delayed", {"delay": 0.02}, reasons=LINE_LOST)
    yield Row(line, "intermittent", expects="either", why=HELD)
    yield Row(line, "duplicated", expects="goes on", why=CURRENT)
    yield Row(line, "reordered", expects="either", why=HELD)


def _down(line: str, quick: bool = False) -> Iterator[Row]:
    """Yield the faults of what the drives hear."""
    yield Row(line, "off", release=True, quick=quick)
    yield Row(line, "stuck", release=True)
    yield Row(line, "garbage")
    yield Row(line, "wrong", release=True)
    yield Row(line, "slow", {"every": 4.0}, release=True)
    yield Row(line, "delayed", {"delay": 0.02}, release=True)
    yield Row(line, "intermittent", release=True)
    yield Row(line, "duplicated", expects="goes on", why=CURRENT)
    yield Row(line, "reordered", release=True)


def _both(line: str, quick: bool = False) -> Iterator[Row]:
    """Yield the faults of a whole line."""
    yield Row(line, "off", reasons=LINE_LOST, quick=quick)
    yield Row(line, "stuck", release=True)
    yield Row(line, "delayed", {"delay": 0.02}, reasons=LINE_LOST)
    yield Row(line, "intermittent", expects="either", why=HELD)
    yield Row(line, "duplicated", expects="goes on", why=CURRENT)


LINES = (
    *_both("bus", quick=True),
    *_up("bus.up"),
    *_down("bus.down"),
    *_up("bus0.up"),
    *_down("bus1.down"),
    *_both(AXIS),
    *_up(f"{AXIS}.up", silent=("DRIVE_SILENT",)),
    *_down(f"{AXIS}.down", quick=True),
)


def _encoder(name: str, quick: bool = False) -> Iterator[Row]:
    """Yield the faults of one encoder of an axis; the other one is its witness."""
    yield Row(name, "stuck", reasons=("ENCODER_FROZEN",), quiet=STILL, quick=quick)
    yield Row(name, "garbage")
    yield Row(name, "wrong", {"offset": 1e-3})
    yield Row(name, "wrong", {"scale": 0.5})
    yield Row(name, "slow", {"every": 4.0}, expects="either", why=HELD)
    yield Row(name, "delayed", {"delay": 0.02}, expects="either", why=HELD)
    yield Row(name, "intermittent", expects="either", why=HELD)
    yield Row(name, "reordered", expects="either", why=HELD)


ENCODERS = (*_encoder(f"{AXIS}.load_encoder", quick=True), *_encoder(f"{AXIS}.motor_encoder"))
DRIVE = (
    Row("safe_torque_off", "off", reasons=("SAFE_TORQUE_OFF",), quick=True),
    Row(f"{AXIS}.demand", "off", release=True),
    Row(f"{AXIS}.demand", "stuck", release=True, quick=True),
    Row(f"{AXIS}.demand", "garbage", quiet=STILL, budget=GARBLED, why=AT_ONCE),
    Row(f"{AXIS}.demand", "wrong", {"scale": -1.0}, quiet=STILL, quick=True),
    Row(f"{AXIS}.demand", "wrong", {"scale": 0.0}, quiet=STILL),
    Row(f"{AXIS}.demand", "wrong", {"scale": 2.0}, quiet=STILL),
    Row(f"{AXIS}.demand", "wrong", {"code": float(0x4210)}, reasons=("DRIVE_OVER_TEMPERATURE",)),
    Row(f"{AXIS}.demand", "wrong", {"code": float(0x8611)}, reasons=("DRIVE_EMERGENCY",)),
    Row(f"{AXIS}.demand", "wrong", {"code": float(0x2310)}, reasons=("DRIVE_EMERGENCY",), loses=f"{AXIS}.resets"),
    Row(f"{AXIS}.demand", "slow", {"every": 4.0}, release=True),
    Row(f"{AXIS}.demand", "delayed", {"delay": 0.02}, release=True),
    Row(f"{AXIS}.demand", "intermittent", release=True),
    Row(f"{AXIS}.demand", "reordered", release=True),
)
NODES = ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor")
BRIEF = "held for a few ms at a time; whoever waits for it judges the age of what it said"
LOST = {
    "force_sensor": STALE,
    "pedal": ("PEDAL_STALE",),
    "admittance": ("COMMAND_STALE",),
    "kinematics": ("COMMAND_STALE",),
    "motor_driver": ("JOINTS_STALE",),
    "supervisor": ("SUPERVISOR_SILENT", "NOT_ENABLED"),
}
"""What is reported first when a process is gone."""
TWICE = ("PUBLISHED_TWICE", "NOT_ENABLED")
"""The supervisor counts publishers; a second supervisor says DISABLED."""
REFUSED = "the second one hears the first on the bus and does not start"
PROCESSES = (
    *(
        Row(f"process.{name}", "stuck", reasons=LOST[name], quick=name in ("admittance", "supervisor"))
        for name in NODES
    ),
    *(Row(f"process.{name}", "stuck", release=True) for name in NODES),
    *(Row(f"process.{name}", "slow", {"every": 4.0}, expects="either", why=BRIEF) for name in NODES),
    *(Row(f"process.{name}", "delayed", {"delay": 0.006}, expects="either", why=BRIEF) for name in NODES),
    *(Row(f"process.{name}", "intermittent", expects="either", why=BRIEF) for name in NODES),
    *(Row(f"process.{name}", "off", reasons=LOST[name]) for name in NODES),
    *(
        Row(f"process.{name}", "duplicated", reasons=TWICE, quick=name == "supervisor")
        for name in NODES
        if name != "motor_driver"
    ),
    Row("process.motor_driver", "duplicated", expects="goes on", why=REFUSED),
)
CLOCKS = ("force_sensor", "pedal", "motor_driver")
SAMPLES = "it takes the time of a tick from its samples; its own clock only fills in for those that stay away"


def _clock(name: str) -> Iterator[Row]:
    """Yield the faults of the clock of a node that stamps what it publishes; without a tick it does nothing."""
    yield Row(name, "off")
    yield Row(name, "stuck")
    yield Row(name, "garbage")
    yield Row(name, "slow", {"every": 4.0}, expects="either", why=HELD)
    yield Row(name, "delayed", {"delay": 0.006}, expects="either", why=HELD)
    yield Row(name, "intermittent", expects="either", why=HELD)
    yield Row(name, "duplicated", expects="either", why=CURRENT)
    yield Row(name, "reordered", expects="either", why=HELD)


CLOCK = (
    # Backwards together cannot be recorded in order, and cannot happen: the offset to the monotonic clock is frozen.
    Row("clock", "wrong", {"offset": 0.05}, quick=True),
    *(Row(f"clock.{name}", "wrong", {"offset": offset}) for name in CLOCKS for offset in (0.05, -0.05)),
    *(row for name in CLOCKS for row in _clock(f"clock.{name}")),
    *(Row(f"clock.{name}", "wrong", {"offset": 0.05}) for name in ("admittance", "kinematics")),
    *(
        Row(f"clock.{name}", "wrong", {"offset": -0.05}, expects="goes on", why=SAMPLES)
        for name in ("admittance", "kinematics")
    ),
)
ROWS = (*FORCE, *PEDAL, *LINES, *ENCODERS, *DRIVE, *SLOW, *SEVERAL, *TOGETHER, *WIRING, *PROCESSES, *CLOCK)
"""All rows, by component."""


def in_one_process(rows: Iterable[Row]) -> tuple[Row, ...]:
    """Return the rows of a loop whose nodes share a process: one is gone, all are, and the wrench is missed first."""
    gone = {f"process.{name}": LOST[name] for name in LOOP}
    return tuple(replace(row, reasons=STALE) if row.reasons == gone.get(row.component) else row for row in rows)
