"""What cannot be what it was taken for: stamps in milliseconds, torques given as places and places as torques."""

from __future__ import annotations

import numpy as np
from sher3_chain.manipulator.mjcf.drives import Drive

from sher3_public.errors import InputError
from sher3_public.records import Array

SLOWEST = 0.5
"""Time between two samples, s, beyond which no motion of a joint is seen."""
BEYOND = 5.0
"""Times a joint's own scatter that the places it was told may scatter. A servo follows; only a torque is in a unit that
has nothing to do with the place."""
FOLLOWS = 0.98
"""Correlation of a motor's force with the place of its joint from which it is taken for the place itself."""
SAME = 2.0
"""Factor within which it then is as large as the place."""


def stamps(time: Array) -> Array:
    """Return stamps (n,); raises InputError where they are too far apart for seconds."""
    apart = float(np.median(np.abs(np.diff(time)))) if len(time) > 1 else 0.0
    if apart > SLOWEST:
        remedy = "give stamps in s: divide those in ms by 1000"
        raise InputError("stamps are too far apart", value=f"{apart:.4g} s", limit=f"{SLOWEST:g} s", remedy=remedy)
    return time


def control_of(name: str, control: Array, position: Array, drive: Drive) -> None:
    """Accept what an actuator was told, (n,), as the model has it: as a place of a servo, or as the force of a motor.

    Raises:
        InputError: it cannot be that.
    """
    known = np.isfinite(control) & np.isfinite(position)
    told, q = drive.factor * control[known], position[known]
    wide, own = float(np.std(told)), float(np.std(q))
    if not wide or not own:
        return
    if drive.servo and wide > BEYOND * own:
        remedy = "give it as effort=, or a model with motors"
        raise InputError(
            f"{name}: its control is no place that servo {drive.name} follows",
            value=f"scatter {wide:.3g}",
            limit=f"{BEYOND:g} times that of the position, {own:.3g}",
            remedy=remedy,
        )
    alike = float(np.corrcoef(told, q)[0, 1])
    if not drive.servo and alike > FOLLOWS and 1.0 / SAME < wide / own < SAME:
        remedy = "give a model with position actuators, or effort="
        raise InputError(
            f"{name}: its control is the place of the joint, and motor {drive.name} takes a force",
            value=f"correlation {alike:.3f}",
            remedy=remedy,
        )
