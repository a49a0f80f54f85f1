"""How noisy the readings of the robot's sensors are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_description.contract import EFFORT_RESOLUTION
from sher3_diagnosis.channel import Array
from sher3_diagnosis.localise.readings import noise_in
from sher3_diagnosis.verdict import Noise

from sher3_gap.signals import RunSignals
from sher3_gap.stages.units import ROTARY_AXES


def noise_of_sensors(runs: Sequence[RunSignals], robot: Robot) -> list[Noise]:
    """Return the noise of encoders and efforts by actuator, of the force sensor and of the tracker's position."""
    out: list[Noise] = []
    for i, (name, a) in enumerate(zip(ACTUATORS, robot.actuators, strict=True)):
        place, force = ("rad", "N*m") if name in ROTARY_AXES else ("m", "N")
        out += _noise(name, "motor", place, [run.motor for run in runs], [i], a.motor_encoder)
        out += _noise(name, "load", place, [run.load for run in runs], [i], a.load_encoder)
        step = EFFORT_RESOLUTION * a.drive.rated
        out += _noise(name, "effort", force, [run.effort for run in runs], [i], step)
    sensor, wrenches = robot.force_sensor, [run.wrench for run in runs]
    out += _noise("force_sensor", "force", "N", wrenches, range(3), sensor.resolution_force)
    out += _noise("force_sensor", "torque", "N*m", wrenches, range(3, 6), sensor.resolution_torque)
    return out + _noise("tip", "position", "m", [run.tracker_position for run in runs], range(3))


def _noise(
    place: str, reading: str, unit: str, records: Sequence[Array | None], columns: Sequence[int], step: float = 0.0
) -> list[Noise]:
    """Return the noise of some columns of records (n, k), as one; nothing where none moves or was recorded."""
    each = [x[:, i] for x in records if x is not None for i in columns if np.ptp(x[:, i]) > 0.0]
    return [noise_in(place, reading, unit, each, step)] if each else []
