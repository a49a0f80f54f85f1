"""Floors of an axis: of a driven one its inputs are asked too, and none is below a count."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Floors, Residual, Residuals
from sher3_diagnosis.localise.floors import UNIFORM

from sher3_chain.axes.view import AxisView
from sher3_chain.floors.foreseen import foreseen
from sher3_chain.floors.innovation import NOTHING, chain_floors, plain_innovation, white_behind


def floors_of(records: Sequence[AxisView], found: Sequence[Residuals], repeats: bool) -> list[Floors]:
    """Return the floor per record and channel of one axis; `repeats` of one motion, or not."""
    return chain_floors(records, found, repeats, resolution_floors, unforeseen)


def unforeseen(view: AxisView, residual: Residual, channel: Channel) -> Array:
    """Return the standard deviation (1,) of white noise with the innovation of a residual, in the residual's unit.

    A straight line, or the past motion and known inputs: whichever foresees more. Inputs also foresee a part of the
    encoder's own noise, since differences correlate its samples; the floor keeps that part.
    """
    noise = resolution_floors(view, UNIFORM * view.noise)[channel]
    return np.minimum(plain_innovation(view, residual, channel), np.maximum(foreseen(view.run, residual), noise))


def resolution_floors(view: AxisView, least: float = 0.0) -> Floors:
    """Return what rounding alone makes: white noise of a count's variance through the filters of the residuals.

    The count, m or rad, is taken to be no smaller than `least`.
    """
    run, axis = view.run, view.described
    count = max(axis.encoder_resolution, least) / UNIFORM
    noise, bend = white_behind(run)
    effort = axis.effort_resolution / UNIFORM * noise
    inertia = view.mass * count * bend
    force = count if axis.servo else max(float(np.hypot(effort, inertia)), NOTHING)
    return {
        Channel("motor_mechanics", axis.name): np.array([max(force, NOTHING)]),
        Channel("transmission", axis.name): np.array([np.sqrt(2.0) * count]),
    }
