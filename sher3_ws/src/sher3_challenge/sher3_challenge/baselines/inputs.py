"""What every baseline gets: the residuals the diagnosis works with, its single fits, and the joint traces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
Place = tuple[str, str]
"""Stage and actuator."""


@dataclass(frozen=True)
class Stage:
    """Nominal residuals of one stage at one actuator.

    Attributes:
        place: stage and actuator.
        floor: mean square of the residual's floor.
        nominal: residuals (n, d) per run.
    """

    place: Place
    floor: float
    nominal: Sequence[Array]


@dataclass(frozen=True)
class Candidate:
    """One effect fitted alone at its stage.

    Attributes:
        effect, family: ids.
        place: stage and actuator whose residual it was fitted to.
        size: number of fitted parameters.
        fitted: residuals (n, d) per run with the effect at its best fit.
    """

    effect: str
    family: str
    place: Place
    size: int
    fitted: Sequence[Array]


@dataclass(frozen=True)
class Traces:
    """Measured and simulated positions of all joints.

    Attributes:
        actuators: names of the columns.
        measured: (n, joints) per run.
        simulated: (n, joints) per run: the nominal model from the recorded set-points.
    """

    actuators: Sequence[str]
    measured: Sequence[Array]
    simulated: Sequence[Array]


@dataclass(frozen=True)
class Inputs:
    """All stages, all effects fitted one at a time, and joint traces; None where set-points are not recorded."""

    stages: Sequence[Stage]
    candidates: Sequence[Candidate]
    traces: Traces | None = None
