"""Kinds of faults that several truth plants have: where they may be and how large. Their laws are each plant's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sher3_description import ACTUATORS

DELTAS = ACTUATORS[:3]
SLIDERS = (*DELTAS, "tilt")
TIP, FORCE_SENSOR, ALL = ("tip",), ("force_sensor",), ("all",)
FRICTION = ("coulomb_friction", "presliding_friction")
"""Effects of the library that stand for much of any friction, and of any lost motion under one."""
ENCODER = ("transmission",)
"""Where an error of an encoder shows first beside its own stage."""


@dataclass(frozen=True)
class Row:
    """What is the same of a kind of fault on every truth plant.

    Attributes:
        family: family of the contract, `outside` for the others.
        stage: where it acts.
        places: actuators on which it can sit.
        start: magnitude at which calibration starts, for a slider.
        least: smallest magnitude that makes sense.
        most: largest one.
        also: other stages where it may show first.
        company: effects of the library that belong to it and are no false accusation.
    """

    family: str
    stage: str
    places: tuple[str, ...]
    start: float
    least: float
    most: float
    also: tuple[str, ...] = ()
    company: tuple[str, ...] = ()


DECLARED: Mapping[str, Row] = {
    "command_delay": Row("timing", "transport", ALL, 1e-3, 5e-5, 8e-3, company=("command_jitter",)),
    "command_jitter": Row("timing", "transport", ALL, 3e-4, 2e-5, 1.5e-3, company=("command_delay",)),
    "dropped_commands": Row("timing", "transport", ALL, 0.02, 0.004, 0.3),
    "axis_skew": Row("timing", "transport", ACTUATORS, 1e-3, 5e-5, 6e-3, company=("command_delay",)),
    "drive_lag": Row("timing", "drive", ACTUATORS, 1e-3, 5e-5, 8e-3),
    "controller_gain": Row("scale", "controller", (*ACTUATORS, "all"), 0.1, 0.01, 0.6),
    "torque_constant": Row("scale", "motor_mechanics", ACTUATORS, 0.05, 0.002, 0.5),
    "lead_error": Row("scale", "transmission", ACTUATORS, 5e-4, 1e-5, 0.02),
    "force_saturation": Row("limit", "drive", ACTUATORS, 0.3, 0.02, 1.35),
    "velocity_deadband": Row("limit", "drive", ACTUATORS, 8e-5, 4e-6, 1.5e-3),
    "payload_mass": Row("inertia", "motor_mechanics", ACTUATORS, 0.2, 0.01, 10.0, company=("gravity_load",)),
    "gravity_load": Row("inertia", "motor_mechanics", SLIDERS, 0.05, 0.002, 3.0, company=("payload_mass",)),
    "cogging": Row("periodic", "motor_mechanics", ACTUATORS, 0.3, 0.01, 8.0),
    "transmission_ripple": Row("periodic", "transmission", ACTUATORS, 2e-6, 5e-8, 5e-5),
    "backlash": Row("lost_motion", "transmission", ACTUATORS, 3e-6, 1e-7, 1e-4, company=FRICTION),
    "transmission_hysteresis": Row("lost_motion", "transmission", ACTUATORS, 2e-6, 1e-7, 1e-4, company=FRICTION),
    "transmission_compliance": Row("compliance", "transmission", ACTUATORS, 1e-6, 5e-8, 1.2e-5, company=("backlash",)),
    "cable_drag_axis": Row("wrench", "motor_mechanics", ACTUATORS, 0.3, 0.01, 8.0),
    "coulomb_friction": Row("friction", "motor_mechanics", ACTUATORS, 0.3, 0.01, 8.0, company=("presliding_friction",)),
    "stribeck_friction": Row("friction", "motor_mechanics", ACTUATORS, 0.4, 0.01, 8.0, company=FRICTION),
    "viscous_friction": Row("friction", "motor_mechanics", ACTUATORS, 60.0, 2.0, 1500.0),
    "presliding_friction": Row("friction", "motor_mechanics", ACTUATORS, 0.3, 0.01, 8.0, company=("coulomb_friction",)),
    "position_friction": Row("friction", "motor_mechanics", ACTUATORS, 0.4, 0.01, 8.0, company=FRICTION),
    "friction_drift": Row("friction", "motor_mechanics", ACTUATORS, 0.5, 0.01, 8.0, company=FRICTION),
    "encoder_scale": Row("scale", "sensing", ACTUATORS, 5e-4, 1e-5, 0.02, also=ENCODER),
    "encoder_eccentricity": Row("periodic", "sensing", ACTUATORS, 2e-6, 5e-8, 5e-5, also=ENCODER),
    "structural_compliance": Row("compliance", "structure", TIP, 0.1, 0.005, 3.0),
    "link_compliance": Row("compliance", "structure", TIP, 0.3, 0.01, 5.0),
    "tool_bending": Row("compliance", "structure", TIP, 1e-5, 5e-7, 4e-4),
    "structural_vibration": Row("compliance", "structure", TIP, 0.5, 0.02, 6.0, also=("mechanism",)),
    "link_length_error": Row("geometry", "mechanism", DELTAS, 5e-6, 2e-7, 3e-4),
    "platform_geometry_error": Row("geometry", "mechanism", DELTAS, 8e-6, 2e-7, 4e-4),
    "rail_tilt": Row("geometry", "mechanism", DELTAS, 2e-3, 5e-5, 5e-2),
    "base_tilt": Row("geometry", "mechanism", TIP, 4e-5, 1e-6, 2e-3),
    "tilt_linkage_error": Row("geometry", "mechanism", ("tilt",), 3e-5, 1e-6, 2e-3),
    "tool_offset": Row("geometry", "mechanism", TIP, 6e-6, 2e-7, 4e-4),
    "encoder_offset": Row("geometry", "mechanism", ACTUATORS, 8e-6, 2e-7, 4e-4),
    "thermal_expansion": Row("drift", "mechanism", TIP, 3e-5, 2e-6, 3e-3),
    "force_drift": Row("drift", "sensing", FORCE_SENSOR, 0.005, 2e-4, 0.5, company=("force_bias",)),
    "force_bias": Row("wrench", "sensing", FORCE_SENSOR, 0.01, 4e-4, 1.0),
    "tool_gravity": Row("wrench", "sensing", FORCE_SENSOR, 0.002, 5e-5, 0.1),
    "force_scale": Row("scale", "sensing", FORCE_SENSOR, 0.03, 1e-3, 0.4),
    "force_crosstalk": Row("wrench", "sensing", FORCE_SENSOR, 0.03, 1e-3, 0.4),
    "cable_drag_sensor": Row("wrench", "sensing", FORCE_SENSOR, 0.03, 1e-3, 1.0),
}
"""Name -> family, stage, places; and the magnitude to start at, the smallest and the largest, in a slider's unit."""
