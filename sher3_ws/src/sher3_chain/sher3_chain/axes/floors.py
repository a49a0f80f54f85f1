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
    return chain_floors(records, found, repeats, reading_floors, innovation_floor)


def innovation_floor(view: AxisView, residual: Residual, channel: Channel) -> Array:
    """Return the standard deviation (1,) of white noise with the innovation of a residual, in the residual's unit.

    A straight line, or the past motion and known inputs: whichever foresees more. Inputs also foresee a part of the
    encoder's own noise, since differences correlate its samples; `of_readings` keeps that part.
    """
    return np.minimum(plain_innovation(view, residual, channel), foreseen(view.run, residual, view.direction))


def reading_floors(view: AxisView) -> Floors:
    """Return what the readings alone make: white noise of the encoder, or of its count, through every law of motion.

    An error of the place is one of speed and acceleration, and a law makes a force of them: the nominal one, and a
    viscous friction that would carry the recorded force alone. A force without noise is met exactly by a constant, and
    by no such law, whatever moves.
    """
    run, axis = view.run, view.described
    place, (noise, pace, bend) = view.noise, white_behind(run)
    effort = axis.effort_resolution / UNIFORM * noise
    force = (
        place if axis.servo else float(np.linalg.norm([effort, view.mass * place * bend, view.thick * place * pace]))
    )
    return {
        Channel("motor_mechanics", axis.name): np.array([max(force, NOTHING)]),
        Channel("transmission", axis.name): np.array([np.sqrt(2.0) * place]),
    }
