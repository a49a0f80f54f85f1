"""Parameters of a fault of a kind, drawn alike on every truth plant. Their laws are each plant's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from sher3_challenge.plants.site import Site

Parameters = dict[str, float]
Drawn = Callable[[Site, float], Parameters]
"""Site, and magnitude in a slider's unit -> parameters by the contract's names."""

LARGEST_FORCE = 12.0
"""Largest force of a slider's drive that is too weak [N]."""
HEAVIEST = 0.015
"""Mass by which a tool may differ from its data [kg]."""


def as_given(name: str) -> Drawn:
    """The magnitude itself."""
    return lambda site, x: {name: x}


def either_way(name: str) -> Drawn:
    """The magnitude with a sign."""
    return lambda site, x: {name: site.sign() * x}


def scaled(name: str, dimension: str) -> Drawn:
    """The magnitude in the actuator's unit."""
    return lambda site, x: {name: site.scaled(x, dimension)}


def waves(dimension: str, *orders: int) -> Drawn:
    """An amplitude and a number of periods per revolution."""
    return lambda site, x: {
        "amplitude": site.scaled(x, dimension),
        "periods_per_rev": float(site.rng.choice(list(orders))),
    }


def along(*names: str) -> Drawn:
    """A vector in any direction."""
    return lambda site, x: dict(zip(names, (x * site.direction()).tolist(), strict=True))


def lean(site: Site, x: float) -> Parameters:
    """An angle about any horizontal axis: its components and its size."""
    angle = site.rng.uniform(0, 2 * math.pi)
    return {"x": x * math.cos(angle), "y": x * math.sin(angle), "angle": x}


def gives_way(site: Site, x: float) -> Parameters:
    """A compliance and its inverse."""
    compliance = site.scaled(x, "compliance")
    return {"compliance": compliance, "stiffness": 1 / compliance}


RELATIVE, FORCE, WIDTH = either_way("relative"), scaled("force", "force"), scaled("width", "length")

DRAWN: Mapping[str, Drawn] = {
    "command_delay": as_given("delay"),
    "command_jitter": as_given("sigma"),
    "dropped_commands": as_given("probability"),
    "axis_skew": as_given("skew"),
    "drive_lag": as_given("time_constant"),
    "controller_gain": RELATIVE,
    "torque_constant": RELATIVE,
    "lead_error": RELATIVE,
    "force_saturation": lambda site, x: {"limit": site.scaled(LARGEST_FORCE, "force") / (1 + x)},
    "velocity_deadband": scaled("width", "speed"),
    "payload_mass": scaled("mass", "inertia"),
    "gravity_load": either_way("mass"),
    "cogging": waves("force", 2, 3, 4, 6, 7, 8),
    "transmission_ripple": waves("length", 1, 2, 3, 4),
    "backlash": WIDTH,
    "transmission_hysteresis": lambda site, x: {"width": 2 * site.scaled(x, "length")},
    "transmission_compliance": gives_way,
    "coulomb_friction": FORCE,
    "viscous_friction": scaled("extra", "stiffness"),
    "presliding_friction": FORCE,
    "friction_drift": lambda site, x: {**FORCE(site, x), "time_constant": site.rng.uniform(0.8, 3.0)},
    "encoder_scale": RELATIVE,
    "encoder_eccentricity": scaled("amplitude", "length"),
    "structural_compliance": as_given("fraction"),
    "link_compliance": as_given("fraction"),
    "tool_bending": as_given("compliance"),
    "link_length_error": either_way("length"),
    "rail_tilt": lean,
    "base_tilt": lean,
    "tool_offset": along("x", "y", "z"),
    "encoder_offset": lambda site, x: {"offset": site.sign() * site.scaled(x, "length")},
    "thermal_expansion": as_given("coefficient"),
    "force_drift": along("fx", "fy", "fz"),
    "tool_gravity": lambda site, x: {"mass": site.sign() * min(x, HEAVIEST)},
    "force_scale": RELATIVE,
}
"""Name of a kind -> how its parameters are drawn. The laws of the other kinds draw theirs themselves."""
