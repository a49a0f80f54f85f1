"""What a fault of the lumped plant may change."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from sher3_description import Robot

from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.lumped.parameters import AXES, Array, TruthParameters


@dataclass
class Rig:
    """Parameters and transport of one run. `region` is where the runs work, for local faults."""

    robot: Robot
    truth: TruthParameters
    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    jitter: float = 0.0
    loss: float = 0.0
    foreign: Foreign = NOTHING
    region: Array = field(default_factory=lambda: np.zeros(AXES))
