"""The robot of one case: nominal values, an individual within specification, and scatter from run to run."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from sher3_description import Robot

from sher3_challenge.plants.arrays import copied, zeros_of
from sher3_challenge.plants.level import Bend, Level
from sher3_challenge.plants.lumped.parameters import (
    AXES,
    Array,
    Drive,
    Geometry,
    Host,
    Motor,
    Sensors,
    Transmission,
    TruthParameters,
)


def scaled(robot: Robot, linear: float, angular: float) -> Array:
    """Return (5,) one value per actuator: `linear` for the sliders, `angular` for roll."""
    return np.array([angular if a.kind == "revolute" else linear for a in robot.actuators])


def nominal(robot: Robot) -> TruthParameters:
    """Return the robot exactly as its file says, without friction or any deviation."""

    def column(get: Callable[..., float]) -> Array:
        return np.array([get(actuator) for actuator in robot.actuators], dtype=float)

    lead = column(lambda a: a.lead)
    ones = np.ones(AXES)
    motor = zeros_of(
        Motor,
        mass=column(lambda a: a.mass),
        viscous=column(lambda a: a.viscous),
        torque_gain=ones,
        gravity_gain=ones,
        stribeck_velocity=ones,
        presliding=scaled(robot, 4e-6, 2e-4),
        friction_period=ones,
        friction_time=ones,
        sticky_width=ones,
        cable_reach=ones,
        mass_period=ones,
        loss_velocity=ones,
        lead=lead,
        own_mass=column(lambda a: a.mass),
        own_viscous=column(lambda a: a.viscous),
    )
    drive = zeros_of(
        Drive,
        kp=column(lambda a: a.drive.kp),
        ki=column(lambda a: a.drive.ki),
        limit=column(lambda a: a.drive.limit),
    )
    transmission = zeros_of(
        Transmission, hysteresis_reach=ones, load_share=np.full(AXES, 0.25), bump_width=ones, lead=lead
    )
    host = zeros_of(
        Host,
        gain=np.full(AXES, robot.position_gain),
        velocity_limit=column(lambda a: a.limits.velocity),
        force_limit=column(lambda a: a.drive.limit),
        motor_resolution=column(lambda a: a.motor_encoder),
        load_resolution=column(lambda a: a.load_encoder),
        lead=lead,
        coupling=np.zeros((AXES, AXES)),
        sag=np.zeros(1),
    )
    sensor = robot.force_sensor
    sensors = Sensors(
        np.ones(1), np.zeros(6), np.zeros(6), np.eye(6), np.array([sensor.tool_mass]), np.array(sensor.tool_com),
        np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(1), np.zeros(3),
    )  # fmt: skip
    return TruthParameters(motor, drive, transmission, host, _geometry(robot), sensors)


def _geometry(robot: Robot) -> Geometry:
    delta, arm, tilt = robot.delta, robot.arm, robot.tilt_linkage
    half = delta.leg_width / 2
    azimuth = np.repeat(np.asarray(delta.leg_azimuth), 2)
    side = np.tile([half, -half], 3)
    radial = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(6)])
    across = np.column_stack([-np.sin(azimuth), np.cos(azimuth), np.zeros(6)]) * side[:, None]
    base = math.sqrt(delta.base_radius**2 - half**2) * radial + across + [0.0, 0.0, delta.slider_zero]
    platform = math.sqrt(delta.platform_radius**2 - half**2) * radial + across
    linkage_zero = math.sqrt(tilt.coupler**2 - (tilt.offset - tilt.crank) ** 2)
    return Geometry(
        rail_ball=base,
        rail=np.tile([0.0, 0.0, 1.0], (3, 1)),
        platform_ball=platform,
        link=np.full(6, delta.link_length),
        clearance=np.zeros(3),
        rattle=np.zeros(3),
        arm=np.array([arm.d1, arm.d2, arm.d3, *arm.tool]),
        linkage=np.array([tilt.crank, tilt.coupler, tilt.offset]),
        linkage_zero=np.array([linkage_zero]),
        base_tilt=np.zeros(3),
        expansion=np.zeros(1),
        bending=np.zeros(1),
        hinge=np.zeros(6),
        link_law=np.array([0.0, delta.link_compliance.b]),
        vibration=np.array([0.0, 10.0, 0.05, 2.0, 0.0]),
        parasitic=np.zeros(3),
        masses=np.array([delta.moving_mass, arm.roll_mass, arm.tilt_mass]),
        roll_com=np.array(arm.roll_com),
        tilt_com=np.array(arm.tilt_com),
    )


def individual(robot: Robot, rng: np.random.Generator, level: Level) -> TruthParameters:
    """Return one robot as built: every number off by a little, at a level of the robot's own."""
    p = nominal(robot)

    def off(array: Array, relative: float) -> None:
        array *= 1 + level.off(rng, relative, array.shape)

    off(p.motor.mass, 1.5e-3)
    off(p.motor.viscous, 0.01)
    off(p.motor.torque_gain, 5e-4)
    off(p.motor.gravity_gain, 2e-3)
    off(p.drive.kp, 1e-3)
    off(p.drive.ki, 1e-3)
    p.motor.coulomb[:] = p.motor.static[:] = scaled(robot, 0.012, 3e-4) * rng.uniform(0.3, 1.2, AXES)
    off(p.motor.presliding, 0.3)
    p.motor.cogging[:] = scaled(robot, 0.01, 2.5e-4) * rng.uniform(0, 1, AXES)
    p.motor.cogging_order[:] = rng.integers(3, 9, AXES)
    p.motor.cogging_phase[:] = rng.uniform(0, 2 * np.pi, AXES)
    p.transmission.lead_error[:] = level.off(rng, scaled(robot, 6.6e-6, 6.6e-6), AXES)
    p.host.eccentricity[:] = np.abs(level.off(rng, scaled(robot, 2e-8, 0.5e-6), AXES))
    p.host.eccentricity_phase[:] = rng.uniform(0, 2 * np.pi, AXES)
    g = p.geometry
    g.rail_ball[...] += level.off(rng, 0.8e-7, (6, 3))
    g.platform_ball[...] += level.off(rng, 0.8e-7, (6, 3))
    g.link[:] += level.off(rng, 0.8e-7, 6)
    g.rail[...] += level.off(rng, 5e-6, (3, 3))
    g.rail[...] /= np.linalg.norm(g.rail, axis=1, keepdims=True)
    g.arm[:] += level.off(rng, 1.5e-7, 6)
    g.base_tilt[:] = level.off(rng, 1e-6, 3)
    p.sensors.force_bias[:] = level.off(rng, np.repeat([2e-4, 2e-6], 3), 6)
    off(p.sensors.force_scale, 5e-4)
    return p


def bend(p: TruthParameters, how: Bend) -> None:
    """Bend the laws of what is no drawing's, in place."""
    for part in (p.motor, p.transmission, p.host):
        part.bend[:], part.bend_rate[:], part.bend_phase[:] = how.size, how.rate, how.phase
    p.motor.bend_quick[:] = how.quick


def scatter(robot: Robot, p: TruthParameters, rng: np.random.Generator) -> TruthParameters:
    """Return the robot in one run: a copy with what changes from run to run drawn anew (friction, viscosity, zeros)."""
    q = copied(p)
    factor = 1 + 0.03 * rng.standard_normal(AXES)
    q.motor.coulomb[:] *= factor
    q.motor.static[:] *= factor
    q.motor.viscous[:] *= 1 + 0.005 * rng.standard_normal(AXES)
    q.motor.weight[:] += scaled(robot, 0.022, 4e-4) * rng.standard_normal(AXES)
    q.motor.wander[:] = scaled(robot, 0.035, 6e-4) * rng.uniform(0.3, 1.0, AXES)
    q.motor.wander_frequency[:] = rng.uniform(0.2, 1.5, AXES)
    q.motor.wander_phase[:] = rng.uniform(0, 2 * np.pi, AXES)
    q.sensors.force_bias[:] += np.repeat([2e-4, 1e-6], 3) * rng.standard_normal(6)
    q.sensors.tracker_bias[:] += 4e-7 * rng.standard_normal(3)
    return q
