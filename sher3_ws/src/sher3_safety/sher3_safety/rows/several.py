"""Faults of several axes at once, of both encoders alike, of what a drive says of itself, and of lively inputs.

They look alike to whoever compares one axis with another, one encoder with the other, or one sample with the next.
"""

from __future__ import annotations

from collections.abc import Iterator

from sher3_safety.rows.row import AIMING, DISABLED, FIRM, IDLE, LIGHT, LIMIT, NOBODY, STATES, STILL, Row
from sher3_safety.rows.slow import ALL, AXIS, FAST, LEFT, LONGEST, ROLL

LEGS = "legs"
DISOBEYS = (*LEFT, "DRIVE_DISOBEYS")
STANDS = (*LEFT, "ENCODER_FROZEN")
DOUBTFUL = ("HAND_DOUBTFUL",)
WRAP = 65536.0 * 1e-8
"""Counts of 16 bits of a load encoder of 10 nm [m]: a counter that wraps, or a homing that is off by as much."""
WARNS = "bit 7 is a warning: it is on /diagnostics, and the drive goes on doing as it is told"
BITS = {"remote": 0x200, "voltage": 0x10, "follows": 0x1000, "limit": 0x800}
"""Bits of the statusword that say that a drive does not do as it is told."""
FREELY = "at 5 mm/s, where 250 um is the budget; near tissue 0.5 mm/s is the cap and 14 um the travel"
ALONG = "the tip goes where the hand pushes, only faster"
BLIND = "0.12 s of motion in which nothing can be compared"
SHAKES = "2 um are no fault to the encoders' own check; the robot may stop since nothing can be compared"
NO_POWER = (
    "a motor that turns without being enabled has lost its power stage or is turned by something else: the driver says "
    "so, sends `disable voltage` and withholds its heartbeat; only safe torque off stops it"
)


def _creeps() -> Iterator[Row]:
    """Yield axes that run away together: the legs then move the tip straight on, and none stands out.

    What drives them is a force that the force sensor does not feel, so the watch of the hand may be the first.
    """
    for speed in (1e-5, 1e-4, 4e-4, 6.5e-4):
        duration = min(LONGEST, max(0.12, 2e-5 / speed))
        quick = speed == 4e-4
        yield Row(f"{LEGS}.power", "creep", {"speed": speed}, reasons=(*LEFT, *DOUBTFUL), slow=True, quiet=FAST,
                  duration=duration, states=ALL, quick=quick)  # fmt: skip
    for speed in (8e-6, 1.2e-5, 1e-4):
        yield Row(f"{LEGS}.demand", "creep", {"speed": speed}, reasons=DISOBEYS, slow=True, quiet=FAST,
                  duration=min(LONGEST, 2e-5 / speed), states=ALL)  # fmt: skip
    for name, speed in ((LEGS, 2e-3), (AXIS, 1e-3), (ROLL, 2e-2)):
        yield Row(f"{name}.motor", "creep", {"speed": speed}, expects="said", reasons=("MOVED_DISABLED",),
                  states=(DISABLED,), why=NO_POWER)  # fmt: skip


def _encoders() -> Iterator[Row]:
    """Yield both encoders of an axis wrong alike: what the drive was told is the only other witness."""
    yield Row("axes.encoders", "stuck", reasons=STANDS, quiet=STILL, states=(*STATES, AIMING), quick=True)
    yield Row(f"{LEGS}.encoders", "stuck", reasons=STANDS, quiet=STILL, states=(*STATES, AIMING))
    for rate in (1e-4, 4e-4):
        yield Row(f"{LEGS}.encoders", "drift", {"rate": rate}, reasons=LEFT, slow=True, quiet=FAST, duration=0.2,
                  states=(*ALL, AIMING))  # fmt: skip
    yield Row(f"{LEGS}.load_encoder", "drift", {"rate": 2e-5}, slow=True, duration=LONGEST, states=(*STATES, AIMING))
    for offset in (5e-5, WRAP):
        yield Row(f"{AXIS}.encoders", "wrong", {"offset": offset}, reasons=LEFT)


def _words() -> Iterator[Row]:
    """Yield drives that say that they do not do as they are told, and do."""
    for bit in BITS.values():
        yield Row(f"{AXIS}.statusword", "wrong", {"code": float(bit)}, reasons=("DRIVE_UNWILLING",))
    yield Row(f"{AXIS}.statusword", "wrong", {"code": float(0x80)}, expects="goes on", why=WARNS)


def _lively() -> Iterator[Row]:
    """Yield inputs that are alive and false."""
    yield Row("pedal", "chatter", {"items": 5.0, "code": 1.0}, reasons=("PEDAL_INVALID",), slow=True, duration=0.6,
              quiet=(IDLE.name,), rest=1.0)  # fmt: skip
    yield Row("force_sensor", "chatter", {"items": 2.0, "offset": 11.0}, reasons=("WRENCH_NOT_FINITE", *DOUBTFUL))
    yield Row("force_sensor", "held", reasons=DOUBTFUL, states=(LIGHT, FIRM, LIMIT), lets_go=True, duration=0.4,
              quick=True)  # fmt: skip
    yield Row("force_sensor", "wrong", {"scale": -1.0}, reasons=DOUBTFUL, states=(LIMIT,), slow=True)
    yield from _forces()
    yield from _blinded()
    for first in (0.0, 1.0):
        yield Row(f"{AXIS}.up", "contradicted", {"first": first}, reasons=("DRIVE_TWICE",))


def _forces() -> Iterator[Row]:
    """Yield a force sensor that feels what nobody exerts, as a step, slowly, about an axis; or is turned, or grows.

    0.18 N is below every limit of the sum, and only the travel without a hand can tell; at 0.02 N/s nothing else
    changes fast enough either. A torque is told by the drives of roll and tilt alone.
    """
    for force, duration, quick in ((0.18, 3.0, True), (0.3, 1.0, False), (1.0, 0.3, False)):
        yield Row("force_sensor", "bias", {"force": force}, reasons=DOUBTFUL, states=(NOBODY,), slow=True,
                  duration=duration, quick=quick)  # fmt: skip
    yield Row("force_sensor", "bias", {"force": 6.0}, reasons=DOUBTFUL, states=(NOBODY,), slow=True, budget=250e-6,
              why=FREELY)  # fmt: skip
    for torque, duration, quick in ((0.005, 1.0, False), (0.03, 0.12, True), (0.1, 0.12, False)):
        yield Row("force_sensor", "bias", {"torque": torque}, reasons=DOUBTFUL, states=(NOBODY,), slow=True,
                  duration=duration, quick=quick)  # fmt: skip
    for rate, duration in ((0.02, 9.0), (0.1, 3.0), (1.0, 1.0)):
        yield Row("force_sensor", "drift", {"rate": rate}, reasons=DOUBTFUL, states=(NOBODY,), slow=True,
                  duration=duration)  # fmt: skip
    yield Row("force_sensor", "turn", {"angle": 1.57}, reasons=DOUBTFUL, states=(FIRM, LIMIT), slow=True)
    yield Row("force_sensor", "ramp", {"rate": 1.0}, reasons=DOUBTFUL, states=(FIRM,), slow=True, duration=1.5,
              budget=250e-6, why=ALONG)  # fmt: skip


def _blinded() -> Iterator[Row]:
    """Yield an encoder that jitters as the hand leaves a sensor that stays: nothing can be compared then."""
    for size in (1e-6, 2e-6, 5e-6):
        yield Row("force_sensor", "held", reasons=DOUBTFUL, states=(LIGHT,), lets_go=True, duration=0.4,
                  beside=Row(f"{AXIS}.encoders", "jitter", {"size": size}, duration=0.4), budget=100e-6, why=BLIND,
                  quick=size == 2e-6)  # fmt: skip
    for force, size in ((3.0, 2e-6), (6.0, 5e-6)):
        for name in (AXIS, LEGS):
            yield Row("force_sensor", "bias", {"force": force}, reasons=(*DOUBTFUL, "POSITION_LEFT"), states=(NOBODY,),
                      slow=True, beside=Row(f"{name}.encoders", "jitter", {"size": size}), budget=250e-6,
                      why=FREELY)  # fmt: skip
    yield Row(f"{AXIS}.load_encoder", "jitter", {"size": 2e-6}, reasons=DOUBTFUL, slow=True, duration=0.4,
              states=(FIRM, LIMIT), expects="either", why=SHAKES)  # fmt: skip


SEVERAL = (*_creeps(), *_encoders(), *_words(), *_lively())
