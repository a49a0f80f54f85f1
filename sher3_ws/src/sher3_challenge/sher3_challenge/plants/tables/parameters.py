"""Parameters of the tables plant as named tuples of arrays, which compiled code takes as they are.

Per-actuator values are (5,) arrays in actuator units (m or rad, N or N m); tables have the actuator as first index.
Zero means that a law is absent. Faults write into the arrays in place.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from sher3_challenge.plants.plant import Array

Value = Any
"""An array over the axes in the robot; a number, or a table, in the slice of one axis."""

SPEEDS, PLACES = 20, 128
"""Nodes of the friction maps over speed (square root) and over position (a ring of `span`)."""


class Motor(NamedTuple):
    """Motor side: masses, force constant, friction maps, forces by position and by the past."""

    mass: Value
    viscous: Value
    force_gain: Value  # (5, CURVE) real over reported force, over |force| from zero to `full`
    full: Value
    gravity_gain: Value  # (5, CURVE) over the position, four `span` wide about zero
    weight: Value  # constant force against positive travel
    friction: Value  # (5, 2, SPEEDS, PLACES) level for travel down and up
    top: Value  # speed at the last node of the friction maps
    span: Value  # travel after which the friction maps repeat
    reach: Value  # travel over which friction turns to 1/e
    slope: Value  # (5, CURVE) of every hysteresis of the axis
    fading: Value  # (5, CURVE) friction over the time since the start, 0 to `fading_end`
    fading_end: Value
    cogging: Value  # (5, RING) force over a revolution
    lead: Value
    cable: Value  # (5, CURVE) force over the distance from `cable_rest`, -cable_span to cable_span
    cable_rest: Value
    cable_span: Value
    cable_loop: Value  # hysteresis of the cable: force, and travel over which it turns
    cable_reach: Value
    mount_mass: Value  # payload on an elastic mount: mass, stiffness, damping, weight
    mount_stiffness: Value
    mount_damping: Value
    mount_weight: Value
    own_viscous: Value  # of the drawing: what is beyond it is bent
    bend: Value  # laws of what is no drawing's: size, rate per position and per speed, phase
    bend_rate: Value
    bend_quick: Value
    bend_phase: Value


class Odd(NamedTuple):
    """Laws that no catalogue names, per actuator."""

    detent: Value  # magnetic force whose phase follows the direction of travel
    detent_order: Value
    resting: Value  # friction that grows while the axis rests
    plough: Value  # friction that grows with the travel since the last reversal
    plough_reach: Value
    engaged: Value  # mass that is taken along beyond a place
    place: Value
    snap: Value  # force of a cable that snaps over
    snap_width: Value
    heat: Value  # share of force lost when the winding is warm from rated force
    crossover: Value  # force that the amplifier swallows about zero
    schedule: Value  # share by which kp falls with speed
    joint: Value  # step of the load where two pieces of rail meet, its width
    joint_width: Value
    grating: Value  # interpolation error of the load encoder: amplitude, period
    grating_period: Value
    repeat: Value  # ticks after which the load encoder repeats a reading
    average: Value  # share of the command before in what the drive takes
    smoothing: Value  # share of the reading before in what the host works with


class Drive(NamedTuple):
    """PI law behind the echoed demand."""

    kp: Value
    ki: Value
    limit: Value
    soft: Value  # 1: the limit is reached gradually
    lag: Value  # of the force, two equal poles together
    band: Value
    rated: Value


class Transmission(NamedTuple):
    """From motor to load."""

    ratio: Value  # relative
    wave: Value  # (5, RING) error over `span`, beside the ratio
    ripple: Value  # (5, RING) error over a revolution
    compliance: Value
    stiffening: Value  # (5, CURVE) stiffness over its secant, by the force's share of `full`
    share: Value  # part of the mass behind the compliance
    gap: Value
    carriage: Value  # behind the gap: mass, contact stiffness, friction
    contact: Value
    brake: Value
    hysteresis: Value  # half width, and travel over which it turns
    hysteresis_reach: Value


class Host(NamedTuple):
    """Host and encoders."""

    gain: Value
    velocity_limit: Value
    motor_count: Value
    load_count: Value
    motor_edge: Value  # offset within a count
    load_edge: Value
    offset: Value
    scale: Value
    eccentricity: Value  # (5, RING) load encoder's error over a revolution
    start: Value  # distance of the start from the set-point


class Mechanism(NamedTuple):
    """Delta of three legs whose links stay parallel, arm, four-bar as a table of its angle."""

    centre: Array  # (3, 3) of the sphere a leg's end runs on, at zero travel
    rail: Array  # (3, 3) direction of the rails
    bow: Array  # (3, 2, CURVE) lateral error of a rail along its stroke
    stroke: Array  # (2,) ends of the tables of `bow`
    length: Array  # (3,)
    arm: Array  # d1 d2 d3 tool
    angle: Array  # (n,) tilt angle over the slider's travel
    travel: Array  # (2,) ends of that table
    linkage: Array  # crank, coupler, offset
    masses: Array  # platform, roll, tilt
    roll_com: Array
    tilt_com: Array


class Tip(NamedTuple):
    """What moves the tip beside the encoders."""

    base_tilt: Array
    expansion: Array  # (1,) 1/K
    bow_warm: Array  # (3,) bow of a rail per kelvin, m at half a span
    spring: Array  # (3,) along x, about y, about z
    hardening: Array  # (CURVE,) compliance over force, 0 to 2 N, about one
    link_law: Array  # (6,) fraction of the links' law
    bending: Array  # (1,) of the tool
    modes: Array  # (2, 3) frequency, damping, gain
    mode_axis: Array  # (2,)
    follow: Array  # (4,) play of a leg or the tilt that follows its slider
    rattle: Array  # (3,) play of a leg that follows the force in each link
    flank: Array  # (CURVE,) how play is taken up, from its middle to its end
    stiction: Array  # (1,) twist of the ball joints by direction
    slip: Array  # (2,) displacement of the tool per force beyond a force
    seat: Array  # (3,) where the tool sits in this run
    strength: Array  # (1,) of the known loads


class Sensor(NamedTuple):
    """Force sensor."""

    matrix: Array  # (6, 6)
    bias: Array  # (6,)
    drift: Array  # (6,) per kelvin
    saturation: Array  # (1,) how much the matrix' off-diagonals lose at 2 N
    tool_mass: Array
    tool_com: Array
    cable: Array  # (2, CURVE) force by roll on y, by tilt on x, -1 to 1 rad
    cable_loop: Array  # (2,) force and reach
    late: Array  # (6,) time constants of the channels
    loop: Array  # (1,) hysteresis of the reading, share of the force


class TableParameters(NamedTuple):
    """One robot in one run."""

    motor: Motor
    odd: Odd
    drive: Drive
    transmission: Transmission
    host: Host
    mechanism: Mechanism
    tip: Tip
    sensor: Sensor
    stray: Array  # (5, 5) force on one axis per force of another drive
