"""Attacks that no list had: how far each moves the tip near tissue, in stepped time, beside its budget.

    python bench/more_attacks.py             # all: half a minute of processor
    python bench/more_attacks.py --only pedal

As `bench/attacks.py`, whose robot and measure these use: 0.8 s each; travel is how far the tip is off its way.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from random import Random

import numpy as np
from attacks import LEGS, PERIOD, TICK, Case, chosen, goes
from sher3_common.operating_state import StateCommand
from sher3_drivers.bus.frame import iter_frames, pack_frames
from sher3_drivers.mock.drive import AxisReading
from sher3_drivers.sensor.device import WrenchRecord
from sher3_faults.requests import make_request
from sher3_runtime.ports import ports
from sher3_safety.rows.row import FIRM, IDLE, LIMIT, MOVING, NOBODY, SIDEWAYS
from sher3_safety.runs.stepped import MatrixRun
from std_srvs.srv import Trigger

Attack = Callable[[MatrixRun], None]
NOISE, CREEP = 2e-8, 1e-3
"""Noise that a frozen encoder shows, two counts [m]; speed of the axis that goes beside another fault [m/s]."""


def frozen_but_noisy(run: MatrixRun) -> None:
    """Let both encoders of a leg stand where they are, with the noise of living ones."""
    stands, random = list[AxisReading](), Random(1)

    def tamper(said: AxisReading) -> AxisReading:
        stands.append(said) if not stands else None
        motor, load = (x + random.gauss(0.0, NOISE) for x in stands[0][:2])
        return said._replace(motor_position=motor, load_position=load)

    run.rig.plant.drives.drives[LEGS[0]].tamper = tamper


def turned(change: Callable[[tuple[float, ...]], tuple[float, ...]]) -> Attack:
    """Return an attack of a force sensor whose six channels are changed."""

    def attack(run: MatrixRun) -> None:
        run.rig.force.tamper = lambda said: [said._replace(wrench=change(said.wrench))]

    return attack


def backwards(run: MatrixRun) -> None:
    """Let the sensor's counter go backwards while the hand leaves."""
    numbers = count(10**6, -1)
    run.rig.force.tamper = lambda said: [said._replace(sequence=next(numbers))]
    run.graph.step(3)
    run.operator.force = 0.0


def old_and_new(run: MatrixRun) -> None:
    """Give each reading of the sensor together with one that is 40 ms old, the old one last."""
    before: list[WrenchRecord] = []

    def tamper(said: WrenchRecord) -> list[WrenchRecord]:
        before.append(said)
        return [said, before[max(0, len(before) - 20)]]

    run.rig.force.tamper = tamper
    run.graph.step(20)
    run.operator.force = 0.0


def cut_frames(run: MatrixRun) -> None:
    """Cut the drives' reports to four bytes of eight on one channel while a leg goes."""
    run.rig.plant.drives.tamper_frames = lambda channel, frames, now: pack_frames(
        f._replace(data=f.data[:4]) if channel == 0 else f for f in iter_frames(frames)
    )
    goes(run, CREEP, LEGS[0])


def beside(component: str, fault: str, axis: str = LEGS[0], **parameters: float) -> Attack:
    """Return an attack of a fault of the list, beside an axis that goes."""

    def attack(run: MatrixRun) -> None:
        run.inject(make_request(component=component, fault=fault, parameters=parameters).to_json())
        goes(run, CREEP, axis)

    return attack


def seldom(name: str, every: int, axis: str) -> Attack:
    """Return an attack in which a process runs in one tick of some, while an axis goes."""

    def attack(run: MatrixRun) -> None:
        node, begun, held = getattr(run.rig, name), ports(run.operator).ticks[0].callback, [False]

        def begin(stamp: int) -> None:
            begun(stamp)
            holds = stamp // TICK % every != 0
            if holds != held[0]:
                (run.graph.pause if holds else run.graph.resume)(node)
                held[0] = holds

        ports(run.operator).ticks[0].callback = begin  # type: ignore[method-assign]
        goes(run, CREEP, axis)

    return attack


def pedal_at(travel: float) -> Attack:
    """Return an attack of a pedal that hangs at a travel under a firm hand."""

    def attack(run: MatrixRun) -> None:
        run.operator.pedal, run.operator.force = travel, 6.0

    return attack


def spam(*commands: StateCommand) -> Attack:
    """Return an attack of commands at every fifth tick, while a leg goes."""

    def attack(run: MatrixRun) -> None:
        goes(run, CREEP, LEGS[0])
        words, step = [command.value for command in commands], run.graph.step
        for tick in range(100):
            run.operator.command(words[tick % len(words)])
            step(5)

    return attack


def a_second_apart(run: MatrixRun) -> None:
    """Let a leg creep below what is found within a second, and the tilt go a second later."""
    goes(run, 6e-6, LEGS[0])
    run.graph.step(round(1.0 / PERIOD))
    goes(run, CREEP, "tilt")


def tare_while_it_ramps(run: MatrixRun) -> None:
    """Tare while the sensor drifts by 0.02 N/s with nobody there, enable, and press the pedal.

    The node is asked itself: threads of the middleware, which would carry a service, do not live on in a fork.
    """
    run.operator.force = 0.0
    run.operator.command(StateCommand.DISABLE.value)
    run.graph.step(300)
    run.inject(make_request(component="force_sensor", fault="drift", parameters={"rate": 0.02}).to_json())
    (service,) = (s for s in run.rig.admittance.services if s.srv_name.endswith("admittance/tare"))
    service.callback(Trigger.Request(), Trigger.Response())
    run.enable(2)
    run.operator.pedal = 1.0


def saturated(wrench: tuple[float, ...]) -> tuple[float, ...]:
    """Return channels that end at 0.5 N."""
    return (*np.clip(wrench[:3], -0.5, 0.5).tolist(), *wrench[3:])


def noisy(wrench: tuple[float, ...]) -> tuple[float, ...]:
    """Return channels with noise of 0.3 N."""
    return (*(x + RANDOM.gauss(0.0, 0.3) for x in wrench[:3]), *wrench[3:])


RANDOM = Random(1)
CASES = (
    Case("both encoders of delta_1 frozen, with noise", frozen_but_noisy, MOVING),
    Case("x and z of the force sensor exchanged", turned(lambda w: (w[2], w[1], w[0], *w[3:])), FIRM),
    Case("y and x of the force sensor exchanged", turned(lambda w: (w[1], w[0], *w[2:])), SIDEWAYS),
    Case("force sensor in another unit, 4.448 times", turned(lambda w: tuple(4.448 * x for x in w)), FIRM),
    Case("force sensor ends at 0.5 N", turned(saturated), LIMIT),
    Case("counter of the force sensor backwards, the hand leaves", backwards, MOVING, leaves=True),
    Case("each force beside one 40 ms old, the hand leaves", old_and_new, MOVING, leaves=True),
    Case("reports of channel 0 cut to half, delta_1 at 1 mm/s", cut_frames, IDLE),
    Case("supervisor runs in one tick of ten, delta_1 at 1 mm/s", seldom("supervisor", 10, LEGS[0]), IDLE),
    Case("kinematics runs in one tick of four, tilt at 1 mm/s", seldom("kinematics", 4, "tilt"), IDLE),
    Case("pedal hangs at 3 %, hand of 6 N", pedal_at(0.03), IDLE),
    Case("pedal chatters, delta_1 at 1 mm/s", beside("pedal", "chatter", items=2.0, code=1.0), MOVING),
    Case("disable and enable in turn, delta_1 at 1 mm/s", spam(StateCommand.DISABLE, StateCommand.ENABLE), IDLE),
    Case("pause and resume in turn, delta_1 at 1 mm/s", spam(StateCommand.PAUSE, StateCommand.RESUME), IDLE),
    Case("delta_1 at 6 um/s, tilt at 1 mm/s a second later", a_second_apart, IDLE),
    Case("tare while the sensor drifts by 0.02 N/s, pedal pressed", tare_while_it_ramps, IDLE),
    Case("noise of 0.3 N on the force sensor, nobody", turned(noisy), NOBODY),
)


if __name__ == "__main__":
    chosen(__doc__, CASES)
