"""Parameters of the truth plant, by part, as named tuples of arrays that compiled code takes as they are.

Per-actuator values are (5,) arrays in actuator units (m or rad, N or N m). Zero means the effect is absent. Faults
write into the arrays in place, so one `TruthParameters` belongs to one run.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]

Value = Any  # (5,) array in the robot; float in the slice of one axis
AXES = 5


class Motor(NamedTuple):
    """Motor-side mechanics: m v' = kt F - friction - viscous v - cogging - cable - gravity + external."""

    mass: Value
    viscous: Value
    torque_gain: Value  # real force over reported effort
    gravity_gain: Value
    weight: Value  # additional constant force of a payload
    wander: Value  # force that wanders slowly within a run: amplitude, frequency, phase
    wander_frequency: Value
    wander_phase: Value
    coulomb: Value
    static: Value
    stribeck_velocity: Value
    presliding: Value  # displacement until full slip
    friction_wave: Value  # friction that varies with position: amplitude, period, phase
    friction_period: Value
    friction_phase: Value
    friction_fading: Value  # friction that decays after the start of a run: amplitude, time constant
    friction_time: Value
    sticky: Value  # friction in one short region: amplitude, place, width
    sticky_place: Value
    sticky_width: Value
    quadratic: Value  # drag per squared speed
    cogging: Value
    cogging_order: Value
    cogging_phase: Value
    cable: Value  # spring of a cable, with its rest position, hysteresis force and displacement
    cable_rest: Value
    cable_loop: Value
    cable_reach: Value
    mass_wave: Value  # mass that varies with position: amplitude, period
    mass_period: Value
    loss: Value  # force lost above a speed: fraction per (v / threshold - 1)
    loss_velocity: Value
    lead: Value  # travel per motor revolution
    own_mass: Value  # of the drawing: what is beyond it is bent
    own_viscous: Value
    bend: Value  # law of what is no drawing's: size, rate per position and per speed, phase
    bend_rate: Value
    bend_quick: Value
    bend_phase: Value


class Drive(NamedTuple):
    """Drive: PI law behind the echoed demand."""

    kp: Value
    ki: Value
    limit: Value
    demand_lag: Value
    current_lag: Value
    deadband: Value
    deadband_soft: Value  # 1: demand less the deadband; 0: demand or nothing
    asymmetry: Value  # relative gain difference between pushing and pulling
    leak: Value  # 1/s, leak of the integrator
    hum: Value  # current oscillation: force amplitude, frequency
    hum_frequency: Value


class Transmission(NamedTuple):
    """From motor to load."""

    lead_error: Value
    ripple: Value
    ripple_order: Value
    ripple_phase: Value
    backlash: Value
    hysteresis: Value  # half width, and displacement until it is built up
    hysteresis_reach: Value
    compliance: Value  # at mid travel; grows with the free length of the screw
    compliance_slope: Value  # relative, per travel unit
    load_share: Value  # part of the moving mass on the load side
    bump: Value  # compliance in one short region: value, place, width
    bump_place: Value
    bump_width: Value
    lead: Value
    bend: Value  # as of the motor
    bend_rate: Value
    bend_phase: Value


class Host(NamedTuple):
    """Host and encoders."""

    gain: Array
    velocity_limit: Array
    force_limit: Array
    command_resolution: Array
    stale: Array  # 1: the host works with the reading of the tick before
    motor_resolution: Array
    load_resolution: Array
    offset: Array  # homing error: both encoders read q + offset
    encoder_scale: Array
    eccentricity: Array
    eccentricity_phase: Array
    encoder_lag: Array
    encoder_loop: Array  # hysteresis of the load encoder: half width
    glitch: Array  # load encoder jumps: size, probability per tick
    glitch_probability: Array
    demand_resolution: Array  # the drive rounds the demand it takes
    demand_slew: Array  # the drive limits the demand's rate; 0: it does not
    lead: Array
    bend: Array  # as of the motor
    bend_rate: Array
    bend_phase: Array
    coupling: Array  # (5, 5) force on i per velocity of j
    sag: Array  # (1,) relative loss of force per share of their limits that all drives use


class Geometry(NamedTuple):
    """Mechanism: six links with their own balls, rails, arm, tilt linkage and deflection."""

    rail_ball: Array  # (6, 3) carriage balls at zero slider travel, {b}
    rail: Array  # (3, 3) rail directions
    platform_ball: Array  # (6, 3) in {p}
    link: Array  # (6,)
    clearance: Array  # (3,) play between slider and platform, per leg
    rattle: Array  # (3,) length between a leg in tension and in compression
    arm: Array  # d1 d2 d3 tool_x tool_y tool_z
    linkage: Array  # crank coupler offset, as built
    linkage_zero: Array  # (1,) slider-to-axis distance at zero tilt, as homed
    base_tilt: Array  # (3,) rotation vector of the base against the tracker
    expansion: Array  # (1,) 1/K relative to 22 degC
    bending: Array  # (1,) m/N of the tool tip, across the tool
    hinge: Array  # (6,) structural compliance at P: c_tx, 1/K_rx, 1/K_ry, 1/K_rz, share at the outer hinge, unused
    link_law: Array  # (2,) a, b of link deflection a |F|^b
    vibration: Array  # (5,) gain, frequency [Hz], damping ratio, direction (0 x, 1 y, 2 z), unused
    parasitic: Array  # (3,) tip displacement per tip speed, in its direction turned by 90 degrees about z; unused
    masses: Array  # moving, roll, tilt
    roll_com: Array
    tilt_com: Array


class Sensors(NamedTuple):
    """Force sensor, tracker and what they add."""

    force_scale: Array  # (1,)
    force_bias: Array  # (6,)
    force_drift: Array  # (6,) per K relative to 22 degC
    crosstalk: Array  # (6, 6), identity when absent
    tool_mass: Array  # (1,)
    tool_com: Array  # (3,)
    cable_force: Array  # (4,) N per rad of roll, N per rad of tilt, hysteresis force, displacement [rad]
    force_lag: Array  # (1,) s
    tracker_bias: Array  # (3,)


class TruthParameters(NamedTuple):
    """One robot in one run."""

    motor: Motor
    drive: Drive
    transmission: Transmission
    host: Host
    geometry: Geometry
    sensors: Sensors
