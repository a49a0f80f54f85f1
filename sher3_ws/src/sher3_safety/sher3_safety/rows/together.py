"""Axes that run away while the robot brakes for another reason, and together, up to the limits of their drives.

The first stop must not hide what comes after it, and the first axis that is found must not hide the others.
"""

from __future__ import annotations

from collections.abc import Iterator

from sher3_control.motion.speed_cap import Regime
from sher3_faults.budget import RUNAWAY

from sher3_safety.rows.row import AXIS, IDLE, LIMIT, MOVING, PAUSED, Row

NEAR, TOP = 2e-3, 12.2e-3
"""Limits of a leg's drive near tissue and elsewhere [m/s]."""
CALM = (IDLE, MOVING)
NEAR_TRAVEL, TOP_TRAVEL = RUNAWAY[Regime.NEAR_TISSUE], RUNAWAY[Regime.FREE]
WHY = "an axis that goes by itself at its drive's own limit: 40 um near tissue, 250 um elsewhere"
UNHEARD = ("JOINTS_STALE", "DRIVE_SILENT", "DRIVE_HOST_LOST", "POSITION_LEFT")
GOES = ("POSITION_LEFT", "DRIVE_DISOBEYS", "HAND_DOUBTFUL")


def _together() -> Iterator[Row]:
    """Yield legs, and all five axes, that run away at the same time."""
    for part in ("power", "demand"):
        for name in ("legs", "axes"):
            yield Row(f"{name}.{part}", "creep", {"speed": NEAR}, reasons=GOES, slow=True, states=CALM,
                      budget=NEAR_TRAVEL, quick=(name, part) == ("axes", "power"), why=WHY)  # fmt: skip
            yield Row(f"{name}.{part}", "creep", {"speed": -TOP}, reasons=GOES, slow=True, states=(*CALM, LIMIT),
                      budget=TOP_TRAVEL, why=WHY)  # fmt: skip


def _while_braking() -> Iterator[Row]:
    """Yield a drive that says EMCY while axes run away as the robot brakes for it, 2 to 30 ms later."""
    for after in (0.002, 0.018, 0.03):
        for name in (AXIS, "legs"):
            for speed, budget in ((NEAR, NEAR_TRAVEL), (TOP, TOP_TRAVEL)):
                yield Row("roll.demand", "wrong", {"code": float(0x8611)}, reasons=("DRIVE_EMERGENCY",), budget=budget,
                          states=CALM if budget == NEAR_TRAVEL else (*CALM, LIMIT), after=after,
                          beside=Row(f"{name}.power", "creep", {"speed": speed}),
                          quick=(after, name, speed) == (0.018, AXIS, NEAR), why=WHY)  # fmt: skip


def _unheard() -> Iterator[Row]:
    """Yield a leg that runs away while the robot stops for a drive, another or its own, that is not heard any more."""
    for name in ("roll.up", "delta_2"):
        yield Row(name, "off", reasons=UNHEARD, states=CALM, budget=NEAR_TRAVEL, after=0.006,
                  beside=Row(f"{AXIS}.power", "creep", {"speed": NEAR}), why=WHY)  # fmt: skip
    for speed, budget in ((NEAR, NEAR_TRAVEL), (TOP, TOP_TRAVEL)):
        yield Row(f"{AXIS}.up", "off", reasons=UNHEARD, states=CALM, budget=budget, after=0.006,
                  beside=Row(f"{AXIS}.power", "creep", {"speed": speed}), why=WHY)  # fmt: skip


def _behind() -> Iterator[Row]:
    """Yield axes that go by themselves behind encoders that stand, which at rest is what healthy encoders do."""
    for name, encoder, goes, speed in (("axes", "load", "tilt", 5e-4), ("legs", "motor", "legs", 1e-3)):
        yield Row(f"{name}.{encoder}_encoder", "stuck", reasons=("ENCODER_FROZEN", "POSITION_LEFT"),
                  budget=NEAR_TRAVEL, after=0.01, states=(*CALM, PAUSED), quick=goes == "tilt", why=WHY,
                  beside=Row(f"{goes}.power", "creep", {"speed": speed}))  # fmt: skip


TOGETHER = (*_together(), *_while_braking(), *_unheard(), *_behind())
