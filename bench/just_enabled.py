"""The first 0.4 s after enabling, in which the watch of the hand knows no mean: false forces, hands that leave, grips.

    python bench/just_enabled.py                # a minute and a half of processor
    python bench/just_enabled.py --grips 100

A false force that nobody exerts, and a hand that was there and leaves while the sensor stays where it was: how far the
tip goes from there. Healthy hands that take hold, at any time, hard or softly: how near they come to a limit. Each in a
fork of a robot that has just been enabled, with the pedal pressed.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from random import Random

import numpy as np
from attacks import FREE, NEAR, ROBOT
from shared_attacks import stays
from sher3_common.operating_state import StateCommand
from sher3_control.motion.speed_cap import Regime
from sher3_control.supervision.hand import HandDetector
from sher3_runtime import Graph
from sher3_safety.runs.stepped import SETTLE, MatrixRun
from sher3_safety.search.forked import forked

TICKS, GRIP_TICKS = 250, 330
"""Ticks for which a false force, and a grip, are watched."""
BEGINS, CAME = (10, 35, 60, 100, 160), (30, 60, 90, 110, 130, 160)
"""Ticks from enabling to a false force; and to the hand's leaving, which came at the 30th of them."""


@contextmanager
def enabled(regime: Regime, seed: int) -> Iterator[MatrixRun]:
    """Give a robot in the tick in which it has been enabled, with nobody there."""
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        run = MatrixRun(graph, ROBOT, seed, regime=regime.value)
        graph.step(SETTLE)
        run.operator.command(StateCommand.ENABLE.value)
        while run.operator.state != "ENABLED":
            graph.step()
        yield run


def farthest(run: MatrixRun, ticks: int = TICKS) -> float:
    """Return how far the tip goes from here, um."""
    tip = run.rig.plant.plant
    begin = np.array(tip.true_tip[1])
    return 1e6 * max(float(np.linalg.norm(tip.true_tip[1] - begin)) for _ in run.graph.steps(ticks))


def nobody(run: MatrixRun, begins: int, force: float) -> float:
    """Return how far a false force leads the tip that begins so many ticks from now."""
    run.graph.step(begins)
    run.operator.pedal = 1.0
    run.rig.force.tamper = lambda said: [
        said._replace(wrench=(*said.wrench[:2], said.wrench[2] + force, *said.wrench[3:]))
    ]
    return farthest(run)


def left(run: MatrixRun, leaves: int, force: float) -> float:
    """Return how far the tip goes once a hand has left that came in the 30th tick; the sensor stays."""
    run.graph.step(CAME[0])
    run.operator.pedal, run.operator.force = 1.0, force
    run.graph.step(leaves)
    stays(run)
    return farthest(run)


def hand_watch(run: MatrixRun) -> HandDetector:
    """Return the watch of the hand of a robot."""
    return next(d for d in run.rig.supervisor.supervisor.detectors if isinstance(d, HandDetector))


def grip(run: MatrixRun, seed: int) -> tuple[float, str]:
    """Return the largest share of a limit of force that a healthy hand comes to, and the state at the end."""
    draw, operator, watch, worst = Random(seed), run.operator, hand_watch(run), 0.0
    force, along = draw.choice((-1, 1)) * 10.0 ** draw.uniform(-1.3, 0.8), draw.random() < 0.6
    at, rise, pedal, lasts = (
        draw.uniform(0, 180),
        draw.choice((1, 5, 15, 50)),
        draw.uniform(0, 200),
        draw.uniform(20, 400),
    )
    name = "force" if along else "across"
    for tick, _ in enumerate(run.graph.steps(GRIP_TICKS)):
        share = min((tick - at) / rise, 1.0 - (tick - at - lasts) / rise)
        setattr(operator, name, (force if along else np.clip(force, -2.0, 2.0)) * min(1.0, max(0.0, share)))
        operator.pedal = float(tick >= pedal)
        found = watch.look(0)
        worst = max(worst, found.value / found.limit * found.unit.startswith("N"))
    return worst, operator.state


def main() -> None:
    """Print what comes of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grips", type=int, default=30, help="of healthy hands, in each regime")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for regime in (NEAR, FREE):
        with enabled(regime, options.seed) as run:
            for what, attack, times in (("nobody there", nobody, BEGINS), ("the hand has left", left, CAME)):
                for force in (0.4, 0.6, 1.0, 3.0, 6.0):
                    ways = [f"{forked(partial(attack, run, ticks, force)):.0f}" for ticks in times]
                    print(
                        f"{regime.value:12}{what:18}{force:g} N, {[2 * t for t in times]} ms: {', '.join(ways)} um",
                        flush=True,
                    )
            worst = [forked(partial(grip, run, 1000 * options.seed + number)) for number in range(options.grips)]
            stopped = sum(state != "ENABLED" for _, state in worst)
            print(
                f"{regime.value:12}{options.grips} grips: {max(w for w, _ in worst):.0%} of a limit, {stopped} stopped",
                flush=True,
            )


if __name__ == "__main__":
    main()
