"""The signals of all joints of a run side by side, on the side of the motors where a transmission couples them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.readings.cut_off import cut_off
from sher3_chain.readings.signals import AxisSignals, signals_of


class JointSignals(AxisSignals):
    """Signals of one axis, with a column for each joint; `load` is NaN where a joint has no second encoder."""

    UNSTATED: ClassVar[float] = 0.0


def joint_signals(run: AxesRun, described: ManipulatorDescription, excitation: str) -> JointSignals:
    """Return the signals of a run, (n, k).

    Args:
        run: the record.
        described: the arm.
        excitation: the name that repeats of the run share.
    """
    each = [signals_of(run, joint, excitation) for joint in described.joints]
    travel = np.asarray(described.coupling if described.coupling is not None else np.eye(len(each)))
    own = np.eye(len(each))
    force = np.linalg.inv(travel) if described.effort_of == "joints" else own
    place = travel if described.position_of == "joints" else own
    effort = np.hstack([_gained(one, joint.gain) for one, joint in zip(each, described.joints, strict=True)])
    return JointSignals(
        name=run.name,
        excitation=excitation,
        period=run.period,
        motor=np.hstack([one.motor for one in each]) @ place.T,
        effort=effort @ force,
        reference=_beside([one.reference for one in each], each[0].motor, np.eye(len(each))),
        load=_beside([one.load for one in each], each[0].motor, travel),
        bandwidth=min(cut_off(one.motor[:, 0], run.period, one.bandwidth) for one in each),
    )


def _gained(one: AxisSignals, gain: float | str) -> Array:
    if one.effort is None:
        return np.zeros_like(one.motor)  # the joint is not judged
    return one.effort * gain if isinstance(gain, float) else one.effort


def _beside(found: Sequence[Array | None], like: Array, travel: Array) -> Array | None:
    """Return positions (n, k) on the side of the motors, NaN where there is none; None without any."""
    if not any(x is not None for x in found):
        return None
    side = np.hstack([np.full_like(like, np.nan) if x is None else x for x in found])
    return side if np.array_equal(travel, np.eye(len(found))) else side @ travel.T
