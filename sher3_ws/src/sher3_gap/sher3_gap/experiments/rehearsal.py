"""Excitations on the simulated robot: runs of a contract case without a graph."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sher3_bags import Run
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_sim import PlantEffect, RunScatter, simulate

from sher3_gap.excitation import Excitation

PAUSE = 2.0
"""Seconds between two runs of a case."""
FIRST_STAMP = 1_700_000_000_000_000_000


def rehearse(
    robot: Robot,
    excitations: Iterable[tuple[Excitation, int]],
    effects: Sequence[PlantEffect] = (),
    *,
    seed: int = 0,
    scatter: RunScatter | None = RunScatter(),  # noqa: B008 - frozen
    temperature: float = REFERENCE_TEMPERATURE,
) -> list[Run]:
    """Simulate each (excitation, repeat) in turn, with scatter and noise of its own, at a temperature [deg C].

    Raises:
        EffectError: an effect does not fit the robot.
    """
    runs, stamp = [], FIRST_STAMP
    for index, (excitation, repeat) in enumerate(excitations):
        number = 1000 * seed + index
        run = simulate(
            robot,
            excitation.position,
            excitation.contact_wrench(),
            effects,
            number,
            setpoint_velocity=excitation.velocity,
            start_stamp=stamp,
            metadata=excitation.metadata(repeat, seed=number),
            scatter=scatter,
            temperature=temperature,
        )
        runs.append(run)
        stamp += round((len(excitation.position) * robot.control_period + PAUSE) * 1e9)
    return runs
