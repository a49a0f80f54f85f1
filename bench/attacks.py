"""Pairs of faults that are in none of the kinds of `sher3 fault`: how far each moves the tip, in stepped time.

    python bench/attacks.py             # all of them
    python bench/attacks.py --only tilt

Each acts for 0.8 s on a robot in a state of the matrix. Travel is how far the tip is off its way, straight on until the
driver is told zero or stops; where the hand leaves, off the place where the tip was then.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from sher3_control.motion.speed_cap import Regime
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.frame import iter_frames, pack_frames
from sher3_drivers.canopen import objects as od
from sher3_drivers.mock.drive import AxisReading
from sher3_drivers.sensor.device import WrenchRecord
from sher3_safety.rows.row import IDLE, LIMIT, MOVING, SIDEWAYS, State
from sher3_safety.runs.stepped import MatrixRun
from sher3_safety.search.trial import Trial, play

ROBOT = load_robot()
TICKS = 400
PERIOD, TICK = ROBOT.control_period, round(ROBOT.control_period * 1e9)
LEGS, NEAR, FREE = ACTUATORS[:3], Regime.NEAR_TISSUE, Regime.FREE
Lost = Callable[[int, int, int, int], bool]
"""Whether a frame is lost: of tick, node id, CAN id, channel."""


def lossy(run: MatrixRun, lost: Lost) -> Callable[[int, bytes, int], bytes]:
    """Return what loses frames on their way."""
    begin = run.rig.plant.drives.clock()

    def tamper(channel: int, frames: bytes, now: int) -> bytes:
        tick = (now - begin) // TICK
        return pack_frames(f for f in iter_frames(frames) if not lost(tick, f.can_id & 0x7F, f.can_id, channel))

    return tamper


def goes(run: MatrixRun, speed: float, *names: str) -> None:
    """Let axes go by themselves [m/s, rad/s]."""
    for name in names:
        run.rig.plant.drives.drives[name].stray = lambda velocity: velocity + speed


def unheard(lost: Lost, speed: float, *names: str) -> Callable[[MatrixRun], None]:
    """Return an attack that loses reports while axes go."""

    def attack(run: MatrixRun) -> None:
        run.rig.plant.drives.tamper_frames = lossy(run, lost)
        goes(run, speed, *names)

    return attack


def without_sync(run: MatrixRun) -> None:
    """Let one channel hear no SYNC while the tilt goes."""
    run.rig.plant.drives.tamper_received = lossy(
        run, lambda t, n, can_id, channel: can_id == od.SYNC_ID and channel == 1
    )
    goes(run, 9e-4, "tilt")


def explained(speed: float, name: str = LEGS[0]) -> Callable[[MatrixRun], None]:
    """Return an attack of an axis that goes and reports the force that would explain it."""

    def attack(run: MatrixRun) -> None:
        drive, went = run.rig.plant.drives.drives[name], [0.0]

        def stray(velocity: float) -> float:
            went[0] += speed * PERIOD
            return velocity + speed

        drive.stray = stray
        drive.tamper = lambda said: said._replace(
            effort=said.effort - drive.scale.hold * (went[0] + speed * drive.scale.settling), velocity_demand=0.0
        )

    return attack


def all_alike(scale: float) -> Callable[[MatrixRun], None]:
    """Return an attack of a leg that takes commands times a scale, and gives both its positions back without it."""

    def attack(run: MatrixRun) -> None:
        drive, began = run.rig.plant.drives.drives[LEGS[0]], list[AxisReading]()

        def tamper(said: AxisReading) -> AxisReading:
            began.append(said) if not began else None
            motor, load = (b + (x - b) / scale for b, x in zip(began[0][:2], said[:2], strict=True))
            return said._replace(motor_position=motor, load_position=load)

        drive.stray, drive.tamper = (lambda velocity: scale * velocity), tamper

    return attack


def mirrored(run: MatrixRun) -> None:
    """Let one channel of the force sensor have the other sign."""
    run.rig.force.tamper = lambda said: [said._replace(wrench=(-said.wrench[0], *said.wrench[1:]))]


def slow_sensor(run: MatrixRun) -> None:
    """Put the force sensor behind a low pass of 0.3 s, and let the hand leave."""
    felt: list[np.ndarray] = []

    def tamper(said: WrenchRecord) -> list[WrenchRecord]:
        now = np.array(said.wrench)
        felt[:] = [felt[0] + PERIOD / 0.3 * (now - felt[0])] if felt else [now]
        return [said._replace(wrench=tuple(felt[0].tolist()))]

    run.rig.force.tamper = tamper
    run.graph.step(3)
    run.operator.force = 0.0


def one_stands(run: MatrixRun) -> None:
    """Let a leg stand and another be twice as fast while channel 1 is heard in one tick of three."""
    run.rig.plant.drives.tamper_frames = lossy(run, lambda tick, node, can_id, channel: channel == 1 and tick % 3 != 0)
    drives = run.rig.plant.drives.drives
    drives[LEGS[0]].stray, drives[LEGS[1]].stray = (lambda velocity: 0.0), (lambda velocity: 2.0 * velocity)


class Case(NamedTuple):
    """An attack, in a state of a regime; where the hand `leaves`, the tip's way ends."""

    name: str
    attack: Callable[[MatrixRun], None]
    state: State
    regime: Regime = NEAR
    leaves: bool = False


BY_TURNS = unheard(lambda tick, node, can_id, channel: (tick + node) % 3 != 0, 2e-3, *LEGS)
ONE_LOST = unheard(lambda tick, node, can_id, channel: node == 1 and tick % 2 == 1, 2e-3, LEGS[0])
NINE_LOST = unheard(lambda tick, node, can_id, channel: tick % 10 != 9, 9e-3, "tilt")
SPEEDS = (1e-4, 4.5e-4, 5.5e-4, 1e-3, 2e-3)
TILTS, ROLLS = (2e-4, 4.5e-4, 9e-4), (0.015, 0.03)
CASES = (
    Case("delta_1 at 2 mm/s, every other report of it lost", ONE_LOST, IDLE),
    Case("legs at 2 mm/s, each drive heard in one tick of three", BY_TURNS, IDLE),
    Case("tilt at 0.9 mm/s, channel 1 hears no SYNC", without_sync, IDLE),
    *(Case(f"delta_1 at {v * 1e3:g} mm/s with the force that explains it", explained(v), IDLE) for v in SPEEDS),
    *(Case(f"tilt at {v * 1e3:g} mm/s with the force that explains it", explained(v, "tilt"), IDLE) for v in TILTS),
    *(Case(f"roll at {v:g} rad/s with the torque that explains it", explained(v, "roll"), IDLE) for v in ROLLS),
    *(
        Case(f"commands and both positions of delta_1 times {k:g}", all_alike(k), state)
        for k in (1.02, 1.1, -1.0)
        for state in (MOVING, SIDEWAYS)
    ),
    Case("x channel of the force sensor with the other sign", mirrored, SIDEWAYS),
    Case("force sensor behind 0.3 s, the hand leaves", slow_sensor, MOVING, leaves=True),
    Case("tilt at 9 mm/s, all reports lost but in one tick of ten", NINE_LOST, IDLE, FREE),
    Case("delta_1 stands, delta_2 twice as fast, channel 1 in one tick of three", one_stands, LIMIT, FREE),
)


def travels(cases: Sequence[Case]) -> list[tuple[float, str]]:
    """Return how far the tip gets off its way in each case [m], and the first reason."""
    return play([Trial(case.attack, case.state, case.regime, TICKS, case.leaves) for case in cases], ROBOT, 1)


def chosen(doc: str | None, cases: Sequence[Case]) -> None:
    """Print a line for each case of those whose name has in it what is asked for."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="only those whose name has this in it")
    only = parser.parse_args().only
    tried = [case for case in cases if only in case.name]
    for case, (way, reason) in zip(tried, travels(tried), strict=True):
        print(f"{way * 1e6:7.1f} um  {case.regime.value:12}{case.state.name:10}{reason:18}{case.name}")


if __name__ == "__main__":
    chosen(__doc__, CASES)
