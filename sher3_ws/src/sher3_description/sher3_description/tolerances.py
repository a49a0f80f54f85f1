"""What a healthy robot may deviate by from its drawing: the recorded-run contract, amendment 1.1, section 1.

A deviation within its tolerance is no gap. Values are three standard deviations or hard limits. What differs from run
to run is measured by repeats; of that only the known tip load stands here, since no repeat need carry one.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from sher3_description.fields import Number, Part

Share = Annotated[Number, Field(gt=0.0, le=0.5)]
"""Relative tolerance: one above a half is a percentage taken for a share."""
Small = Annotated[Number, Field(gt=0.0, le=0.01)]
"""Tolerance of a length [m], an angle [rad] or a mass [kg]: one above 0.01 is in another unit."""


class Tolerances(Part):
    """Tolerances of one robot as built; those it does not state are SHER's.

    Attributes:
        mass, viscous, gravity_load, torque_constant: of an axis, relative.
        friction: Coulomb friction beyond the nominal, share of the rated force.
        ratio: of motor to load, relative.
        ripple, ripple_roll: of the transmission, m and rad.
        ball_centre, link_length: m.
        rail: lean, rad.
        tool, four_bar: lengths, m.
        tool_mass: kg.
        expansion: 1/K.
        compliance: share of the lumped model.
        force_bias, torque_bias: of the force sensor, N and N m.
        force_matrix: of its matrix, relative; force from moment and the reverse in proportion to the ranges.
        known_load: stated tip loads, relative, from run to run.
    """

    mass: Share = 0.01
    viscous: Share = 0.05
    gravity_load: Share = 0.005
    torque_constant: Share = 0.002
    friction: Share = 3e-4
    ratio: Share = 2e-5
    ripple: Small = 0.05e-6
    ripple_roll: Small = 50e-6
    ball_centre: Small = 0.25e-6
    link_length: Small = 0.25e-6
    rail: Small = 50e-6
    tool: Small = 1e-6
    four_bar: Small = 1e-6
    tool_mass: Small = 1e-4
    expansion: Small = 0.4e-6
    compliance: Share = 1e-3
    force_bias: Small = 0.6e-3
    torque_bias: Small = 6e-6
    force_matrix: Share = 1e-3
    known_load: Share = 0.005
