"""The ghosts that the command line asks for: other bags, and simulators driven as the recorded robot was."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sher3_bags import Run, read_run
from sher3_description import Robot
from sher3_effects import load_effects

from sher3_view.film import Film
from sher3_view.ghost import Ghost, ghost_of, simulated

NOMINAL = "nominal"


def ghosts_asked(
    film: Film, run: Run, bags: Sequence[Path], simulators: Sequence[str], exaggeration: float, robot: Robot | None
) -> list[Ghost]:
    """Return the ghosts beside the film of a run.

    Args:
        film: of the run.
        run: that drives the simulators.
        bags: other recordings.
        simulators: `nominal`, or the path of an effects file.
        exaggeration: of the distances.
        robot: by default the one in each bag.

    Raises:
        ViewError: nothing to show. FileError, EffectError: a file is no effects file. BagError: a bag does not read.
    """
    ghosts = [ghost_of(film, read_run(bag, check=False), exaggeration, robot) for bag in bags]
    for simulator in simulators:
        effects = [] if simulator == NOMINAL else load_effects(Path(simulator))
        name = "nominal simulator" if simulator == NOMINAL else f"simulator with {Path(simulator).name}"
        ghosts.append(ghost_of(film, simulated(run, effects, robot), exaggeration, robot, name))
    return ghosts
