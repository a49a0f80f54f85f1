"""Residuals and floors of a force sensor; every eighth reading is held out in turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.whitened import Whitened
from sher3_machines.thresholds import BLOCKS

from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.frames import Frame, frames
from sher3_static.sensor.record import SensorRun
from sher3_static.sensor.view import ReadingsView

READING = Channel("sensing", "force_sensor")
"""The one channel of a sensor."""
STATED = 1.1
"""Error of the stated frame over that of the best one up to which the stated frame is believed: noise makes the wrong
frame better by less than a tenth with twenty readings. Set by that argument."""


@dataclass(frozen=True, kw_only=True)
class SensorEvidence(Evidence):
    """The engine's evidence for one sensor.

    Attributes:
        mass, moment: nominal or identified, kg and (3,) kg m.
        identified: whether they were identified.
    """

    mass: float
    moment: Array
    identified: bool


def gather_sensor(description: SensorDescription, runs: Sequence[SensorRun]) -> SensorEvidence:
    """Compute the residuals of all readings; an unknown load is identified first."""
    wrench, turn = (np.concatenate([getattr(run, name) for run in runs]) for name in ("wrench", "turn"))
    warm = np.nan_to_num(np.concatenate([run.temperature - run.temperature[0] for run in runs]))
    load = description.load
    identified = load.mass == "unknown"
    if isinstance(load.mass, float):
        mass, moment = load.mass, load.mass * np.array(load.centre)
    else:
        mass, moment = identify(wrench, turn)
    view = ReadingsView(turn, mass, moment, warm, wrench[:, :3])
    floor = floors(wrench, turn, warm)
    if description.noise_force is not None and description.noise_torque is not None:
        floor = np.repeat([description.noise_force, description.noise_torque], 3)
    fold = np.arange(len(wrench)) % BLOCKS
    residual = wrench - view.wrench(0)
    data = Whitened(
        [view] * BLOCKS, [{READING: Residual(residual, fold == k)} for k in range(BLOCKS)], [{READING: floor}] * BLOCKS
    )
    return SensorEvidence(
        excitations=[view.excitation] * BLOCKS,
        data=data,
        units={READING: "N"},
        places={"force_sensor": (READING.actuator,)},
        mass=mass,
        moment=moment,
        identified=identified,
    )


def identify(wrench: Array, turn: Array) -> tuple[float, Array]:
    """Return mass, kg, and first moment (3,), kg m, in the stated frame, from the frame in which readings fit best.

    A frame may be turned by any angle: each is tried as it is, and turned by what fits the forces best.
    """
    tried = [(frame, np.eye(3)) for frame in frames()]
    view = ReadingsView(turn, 0.0, np.zeros(3), np.zeros(len(wrench)), wrench[:, :3])
    tried += [(f, Rotation.from_rotvec(view.turn(k)).as_matrix()) for k, f in enumerate(frames())]
    fits = [load_in(frame, wrench, turn, further) for frame, further in tried]
    best = min(range(len(fits)), key=lambda k: fits[k][0])
    chosen = 0 if fits[0][0] < STATED * fits[best][0] and fits[0][1] > 0.0 else best
    _, mass, moment = fits[chosen]
    frame, further = tried[chosen]
    return mass, frame.turn.T @ further.T @ moment


def load_in(frame: Frame, wrench: Array, turn: Array, further: Array) -> tuple[float, float, Array]:
    """Return the rms error of the forces, N, mass and first moment of readings in one frame, with a free bias.

    Args:
        frame: of the list.
        wrench: (n, 6) readings.
        turn: (n, 3, 3) stated orientations.
        further: (3, 3) turn of the readings beyond that frame.
    """
    gravity = frame.gravity(turn) @ further.T
    centred, force = gravity - gravity.mean(axis=0), wrench[:, :3] - wrench[:, :3].mean(axis=0)
    mass = max(float(np.sum(centred * force) / np.sum(centred**2)), 0.0)
    rows = np.concatenate([np.cross(axis, centred)[:, :, None] for axis in np.eye(3)], axis=2)
    torque = wrench[:, 3:] - wrench[:, 3:].mean(axis=0)
    moment = np.linalg.lstsq(rows.reshape(-1, 3), torque.ravel(), rcond=None)[0]
    return float(np.sqrt(np.mean((force - mass * centred) ** 2))), mass, moment


def floors(wrench: Array, turn: Array, warm: Array) -> Array:
    """Return the standard deviation of a reading (6,): what no linear sensor in any frame, drifting, explains."""
    time = np.linspace(-0.5, 0.5, len(wrench))
    x = np.column_stack([np.ones(len(wrench)), turn.reshape(-1, 9), time, warm])
    left = wrench - x @ np.linalg.lstsq(x, wrench, rcond=None)[0]
    free = max(1, len(wrench) - int(np.linalg.matrix_rank(x)))
    each = np.sqrt(np.sum(left**2, axis=0) / free)
    pooled = [np.sqrt(np.mean(each[part] ** 2)) for part in (slice(0, 3), slice(3, 6))]
    return np.repeat(np.maximum(pooled, np.finfo(float).eps), 3)
