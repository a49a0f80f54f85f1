"""Attacks on what watches share, a clock, stamps, rates, counters, the order of frames: travel of the tip near tissue.

    python bench/shared_attacks.py                  # all: half a minute of processor
    python bench/shared_attacks.py --only clock

As `bench/attacks.py`, whose robot and measure these use: 0.8 s each; travel is how far the tip is off its way.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import count

import numpy as np
from attacks import LEGS, TICK, Case, chosen, goes
from sher3_common.operating_state import StateCommand
from sher3_common.samples import TextSample
from sher3_drivers.bus.frame import iter_frames, pack_frames
from sher3_drivers.canopen.protection import COUNTS
from sher3_drivers.mock.drive import AxisReading
from sher3_drivers.sensor.device import WrenchRecord
from sher3_runtime.ports import ports
from sher3_safety.rows.row import FIRM, IDLE, MOVING
from sher3_safety.runs.stepped import GRACE, MatrixRun

Attack = Callable[[MatrixRun], None]
CREEP, NOISE = 1e-3, np.array([3e-3, 3e-3, 3e-3, 1e-4, 1e-4, 1e-4])
"""Speed of the axis that goes [m/s]; noise of the force sensor [N, N m]."""
EMERGENCY = 0x2310
"""Code of an emergency that stops the robot: over-current."""


def stays(run: MatrixRun, gives: Callable[[int], bool] = lambda _: True, **change: float) -> None:
    """Let the hand leave and the sensor stay where it was, with its noise; it speaks in the ticks that `gives` names.

    `change`: what a channel, `c0` to `c5`, says instead.
    """
    was, random, ticks = list[tuple[float, ...]](), np.random.default_rng(1), count()

    def tamper(said: WrenchRecord) -> list[WrenchRecord]:
        was.append(said.wrench) if not was else None
        now = [change.get(f"c{n}", x) for n, x in enumerate((was[0] + random.normal(0.0, NOISE)).tolist())]
        return [said._replace(wrench=tuple(now))] if gives(next(ticks)) else []

    run.rig.force.tamper, run.operator.force = tamper, 0.0


def clock(name: str, ticks: int) -> Attack:
    """Return an attack that sets the clock of a process some ticks ahead, while the sensor stays as the hand leaves."""

    def attack(run: MatrixRun) -> None:
        for tick in ports(getattr(run.rig, name)).ticks:
            call = tick.callback
            tick.callback = partial(lambda call, stamp: call(stamp + ticks * TICK), call)  # type: ignore[method-assign]
        stays(run)

    return attack


def half_rate(run: MatrixRun) -> None:
    """Let the sensor speak in every other tick."""
    stays(run, lambda tick: tick % 2 == 0)


def by_turns(run: MatrixRun) -> Callable[[int], bool]:
    """Lose the reports of a leg in every other tick; return in which ticks the sensor is to speak: in these."""
    drives, speaks = run.rig.plant.drives, lambda _: drives.clock() // TICK % 2 == 0

    def tamper(channel: int, frames: bytes, now: int) -> bytes:
        return pack_frames(f for f in iter_frames(frames) if not (speaks(now) and f.can_id & 0x7F == 1))

    drives.tamper_frames = tamper
    return speaks


def never_together(run: MatrixRun) -> None:
    """Let sensor and drives be heard by turns as the hand leaves: what is compared never meets."""
    stays(run, by_turns(run))


def bias_by_turns(run: MatrixRun) -> None:
    """Let sensor and drives be heard by turns while nobody is there and the sensor says 1 N; enable, and press."""
    run.operator.command(StateCommand.DISABLE.value)
    run.operator.force = run.operator.pedal = 0.0
    run.graph.step(GRACE)
    stays(run, by_turns(run), c2=1.0)
    run.graph.step(GRACE)
    run.enable(2)
    run.operator.pedal = 1.0


def reversed_order(run: MatrixRun) -> None:
    """Send the reports of each channel in reverse order, while a leg goes."""
    run.rig.plant.drives.tamper_frames = lambda channel, frames, now: pack_frames([*iter_frames(frames)][::-1])
    goes(run, CREEP, LEGS[0])


def late_by(ticks: int) -> Attack:
    """Return an attack that holds back the frames of channel 0 for some ticks; the leg goes once the first come."""

    def attack(run: MatrixRun) -> None:
        kept: list[bytes] = []

        def tamper(channel: int, frames: bytes, now: int) -> bytes:
            if channel:
                return frames
            kept.append(frames)
            if len(kept) <= ticks:
                return frames
            if len(kept) == ticks + 1:
                goes(run, CREEP, LEGS[0])
            return kept[-1 - ticks]

        run.rig.plant.drives.tamper_frames = tamper

    return attack


def stale_echoes(run: MatrixRun) -> None:
    """Let every drive echo the demand of five ticks before, while a leg goes."""
    for drive in run.rig.plant.drives.drives.values():
        said: list[float] = []

        def tamper(reading: AxisReading, said: list[float] = said) -> AxisReading:
            said.append(reading.velocity_demand)
            return reading._replace(velocity_demand=said[max(0, len(said) - 6)])

        drive.tamper = tamper
    goes(run, CREEP, LEGS[0])


def jumps(seconds: float) -> Attack:
    """Return an attack in which time jumps while the robot brakes, and a leg goes on."""

    def attack(run: MatrixRun) -> None:
        run.rig.plant.drives.drives["roll"].emergency(EMERGENCY)
        goes(run, CREEP, LEGS[0])
        run.graph.jump(seconds)

    return attack


def restarts(run: MatrixRun) -> None:
    """Let the process of the force sensor end and a new one begin at once, which stays as the hand leaves."""
    run.graph.pause(run.rig.force_sensor)
    run.rig.start_again("force_sensor")
    stays(run)


def regime_in_a_stop(run: MatrixRun) -> None:
    """Ask for the free regime while the robot brakes for an emergency and the tilt goes on."""
    run.rig.plant.drives.drives["roll"].emergency(EMERGENCY)
    goes(run, CREEP, "tilt")
    run.graph.probe(sends=("command/regime",)).send("command/regime", TextSample("free"))


STAYS = "it stays as the hand leaves"
CASES = (
    Case(f"clock of the force sensor 2 ms behind, {STAYS}", clock("force_sensor", -1), FIRM, leaves=True),
    Case(f"clock of the force sensor 6 ms behind, {STAYS}", clock("force_sensor", -3), FIRM, leaves=True),
    Case(f"clock of the force sensor 2 ms ahead, {STAYS}", clock("force_sensor", 1), FIRM, leaves=True),
    Case(f"force sensor at half its rate, {STAYS}", half_rate, FIRM, leaves=True),
    Case(f"sensor and drives heard by turns, {STAYS}", never_together, FIRM, leaves=True),
    Case(
        "sensor and drives heard by turns, it says 1 N, enabled and pressed",
        bias_by_turns,
        IDLE,
        leaves=True,
    ),
    Case(f"NaN in torque z of the force sensor, {STAYS}", partial(stays, c5=float("nan")), FIRM, leaves=True),
    Case(f"process of the force sensor restarts, {STAYS}", restarts, FIRM, leaves=True),
    Case("reports in reverse order, delta_1 at 1 mm/s", reversed_order, IDLE),
    Case("reports of channel 0 a tick late, delta_1 at 1 mm/s", late_by(1), MOVING),
    Case(f"reports of channel 0 {COUNTS} ticks late, delta_1 at 1 mm/s", late_by(COUNTS), MOVING),
    Case("echoes five ticks old, delta_1 at 1 mm/s", stale_echoes, MOVING),
    Case("time jumps by 1 s while it brakes, delta_1 at 1 mm/s", jumps(1.0), IDLE),
    Case("time jumps by -0.05 s while it brakes, delta_1 at 1 mm/s", jumps(-0.05), IDLE),
    Case("free asked for while it brakes, tilt at 1 mm/s", regime_in_a_stop, IDLE),
)


if __name__ == "__main__":
    chosen(__doc__, CASES)
