"""One robot of the tables plant: as its file says, as built within tolerance, and as it is in one run.

Tolerances are those of the contract's amendment, section 1: three standard deviations or hard limits.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_description import Robot

from sher3_challenge.plants.arrays import copied, zeros_of
from sher3_challenge.plants.level import Bend, Level
from sher3_challenge.plants.plant import AXES, Array
from sher3_challenge.plants.site import ANGULAR
from sher3_challenge.plants.tables import parameters as parts
from sher3_challenge.plants.tables.curves import CURVE, RING, loop_slope, ring, wobble
from sher3_challenge.plants.tables.mechanism import angle_table
from sher3_challenge.plants.tables.parameters import PLACES, SPEEDS, TableParameters

SPAN = 3e-3
"""Travel of a slider after which its friction map repeats [m]."""


def scaled(robot: Robot, value: float, dimension: str) -> Array:
    """Return (5,) a slider's value for every actuator, in its unit."""
    return np.array([value * (ANGULAR[dimension] if a.kind == "revolute" else 1.0) for a in robot.actuators])


def nominal(robot: Robot) -> TableParameters:
    """Return the robot exactly as its file says."""
    column = {
        name: np.array([float(getattr(a, name)) for a in robot.actuators])
        for name in ("mass", "viscous", "lead", "motor_encoder", "load_encoder")
    }
    drive = {
        name: np.array([float(getattr(a.drive, name)) for a in robot.actuators])
        for name in ("kp", "ki", "limit", "rated")
    }
    top = np.array([a.limits.velocity for a in robot.actuators])
    ones = np.ones(AXES)
    motor = zeros_of(
        parts.Motor,
        mass=column["mass"],
        viscous=column["viscous"],
        force_gain=np.ones((AXES, CURVE)),
        full=0.4 * drive["rated"],
        gravity_gain=np.ones((AXES, CURVE)),
        friction=np.zeros((AXES, 2, SPEEDS, PLACES)),
        top=top,
        span=scaled(robot, SPAN, "length"),
        reach=scaled(robot, 3e-6, "length"),
        slope=np.tile(loop_slope(np.random.default_rng(7)), (AXES, 1)),
        fading=np.zeros((AXES, CURVE)),
        fading_end=ones,
        cogging=np.zeros((AXES, RING)),
        lead=column["lead"],
        cable=np.zeros((AXES, CURVE)),
        cable_span=ones,
        cable_reach=ones,
        own_viscous=column["viscous"],
    )
    odd = zeros_of(
        parts.Odd, plough_reach=ones, snap_width=ones, joint_width=ones, grating_period=ones, detent_order=ones
    )
    transmission = zeros_of(
        parts.Transmission,
        wave=np.zeros((AXES, RING)),
        ripple=np.zeros((AXES, RING)),
        stiffening=np.ones((AXES, CURVE)),
        share=np.full(AXES, 0.3),
        carriage=scaled(robot, 0.03, "inertia"),
        contact=scaled(robot, 6e5, "force") / scaled(robot, 1.0, "length"),
        brake=scaled(robot, 0.05, "force"),
        hysteresis_reach=ones,
    )
    host = zeros_of(
        parts.Host,
        gain=np.full(AXES, robot.position_gain),
        velocity_limit=top,
        motor_count=column["motor_encoder"],
        load_count=column["load_encoder"],
        eccentricity=np.zeros((AXES, RING)),
    )
    return TableParameters(
        motor, odd, zeros_of(parts.Drive, **drive), transmission, host, _mechanism(robot), _tip(), _sensor(robot),
        np.zeros((AXES, AXES)),
    )  # fmt: skip


def _mechanism(robot: Robot) -> parts.Mechanism:
    delta, arm, tilt = robot.delta, robot.arm, robot.tilt_linkage
    half = delta.leg_width / 2
    radius = math.sqrt(delta.base_radius**2 - half**2) - math.sqrt(delta.platform_radius**2 - half**2)
    azimuth = np.asarray(delta.leg_azimuth)
    centre = np.column_stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(3, delta.slider_zero)])
    limits = robot.actuators[4].limits
    travel = np.array([limits.lower, limits.upper])
    linkage = np.array([tilt.crank, tilt.coupler, tilt.offset])
    stroke = np.array([robot.actuators[0].limits.lower, robot.actuators[0].limits.upper])
    return parts.Mechanism(
        centre, np.tile([0.0, 0.0, 1.0], (3, 1)), np.zeros((3, 2, CURVE)), stroke, np.full(3, delta.link_length),
        np.array([arm.d1, arm.d2, arm.d3, *arm.tool]), angle_table(linkage, travel), travel, linkage,
        np.array([delta.moving_mass, arm.roll_mass, arm.tilt_mass]), np.array(arm.roll_com), np.array(arm.tilt_com),
    )  # fmt: skip


def _tip() -> parts.Tip:
    x = np.linspace(0.0, 1.0, CURVE)
    take_up = np.clip((x - 0.75) / 0.25, 0.0, 1.0) ** 1.5
    return parts.Tip(
        np.zeros(3), np.zeros(1), np.zeros(3), np.zeros(3), 1.2 - 0.4 * x, np.zeros(6), np.zeros(1),
        np.array([[10.0, 0.05, 0.0], [25.0, 0.05, 0.0]]), np.array([1.0, 2.0]), np.zeros(4), np.zeros(3), take_up,
        np.zeros(1), np.array([0.0, 1.0]), np.zeros(3), np.ones(1),
    )  # fmt: skip


def _sensor(robot: Robot) -> parts.Sensor:
    sensor = robot.force_sensor
    return parts.Sensor(
        np.eye(6), np.zeros(6), np.zeros(6), np.zeros(1), np.array([sensor.tool_mass]), np.array(sensor.tool_com),
        np.zeros((2, CURVE)), np.array([0.0, 1.0]), np.zeros(6), np.zeros(1),
    )  # fmt: skip


def individual(robot: Robot, rng: np.random.Generator, level: Level) -> TableParameters:
    """Return one robot as built."""
    p = nominal(robot)
    m, g = p.motor, p.mechanism
    rated = p.drive.rated

    def off(array: Array, three_sigma: float) -> None:
        array *= 1 + level.off(rng, three_sigma / 3, array.shape)

    off(m.mass, 0.01)
    off(m.viscous, 0.05)
    m.force_gain[:] *= 1 + level.off(rng, 0.002 / 3, (AXES, 1))
    m.gravity_gain[:] *= 1 + level.off(rng, 0.005 / 3, (AXES, 1))
    friction = 3e-4 * rated * rng.uniform(0.2, 0.7, AXES)
    for j in range(AXES):
        m.slope[j] = loop_slope(rng)
        along = [0.2 * np.interp(np.linspace(0, RING, PLACES, False), np.arange(RING), ring(rng)) for _ in range(2)]
        m.friction[j] = friction[j] * (wobble(rng, 0.1, SPEEDS)[None, :, None] + np.array(along)[:, None, :])
        p.transmission.ripple[j] = ring(rng) * rng.uniform(0, 0.15)  # the tolerance is from peak to peak
    p.transmission.ripple[:] *= np.where(np.arange(AXES) == 3, 50e-6, 0.05e-6)[:, None]
    p.transmission.ratio[:] = level.off(rng, 2e-5 / 3, AXES)
    g.centre[:, :] += level.off(rng, 0.25e-6 / 3, (3, 3))
    g.length[:] += level.off(rng, 0.25e-6 / 3, 3)
    g.rail[:, :2] += level.off(rng, 50e-6 / 3, (3, 2))
    for leg in range(3):
        for side in range(2):
            g.bow[leg, side] = 3e-8 * (wobble(rng, 1.0) - 1.0)
    g.arm[:] += level.off(rng, 1e-6 / 3, 6)
    g.linkage[:] += level.off(rng, 1e-6 / 3, 3)
    g.angle[:] = angle_table(g.linkage, g.travel)
    p.tip.expansion[0] = level.off(rng, 0.4e-6 / 3)
    p.tip.spring[:] = level.off(rng, 1e-3 / 3) * SPRINGS
    ranges = np.array([*robot.force_sensor.range_force, *robot.force_sensor.range_torque])
    p.sensor.matrix[:] += level.off(rng, 1e-3 / 3, (6, 6)) * ranges[:, None] / ranges[None, :]
    p.sensor.bias[:] = level.off(rng, np.repeat([0.6e-3, 6e-6], 3) / 3, 6)
    p.sensor.tool_mass[:] += level.off(rng, 1e-4 / 3)
    return p


SPRINGS = np.array([15e-6, 1 / 244, 1 / 213])
"""The published lumped compliance of the arm: along x [m/N], about y and z [rad/(N m)]."""


def bend(p: TableParameters, how: Bend) -> None:
    """Bend the laws of what is no drawing's, in place."""
    p.motor.bend[:], p.motor.bend_rate[:], p.motor.bend_quick[:], p.motor.bend_phase[:] = how


def scatter(robot: Robot, p: TableParameters, rng: np.random.Generator) -> TableParameters:
    """Return the robot in one run: a copy with what changes from run to run drawn anew."""
    q = copied(p)
    q.motor.friction[:] *= 1 + 0.05 / 3 * rng.standard_normal((AXES, 1, 1, 1))
    q.motor.viscous[:] *= 1 + 0.05 / 3 * rng.standard_normal(AXES)
    q.motor.weight[:] += 5e-4 / 3 * q.drive.rated * rng.standard_normal(AXES)
    q.mechanism.centre[:, :] += 0.25e-6 / 3 * rng.standard_normal((3, 3))
    q.host.motor_edge[:] = q.host.motor_count * rng.uniform(-0.5, 0.5, AXES)
    q.host.load_edge[:] = q.host.load_count * rng.uniform(-0.5, 0.5, AXES)
    q.host.start[:] = scaled(robot, 0.5e-6, "length") / 3 * rng.standard_normal(AXES)
    q.tip.seat[:] = 2e-6 / 3 / math.sqrt(3) * rng.standard_normal(3)
    q.tip.strength[0] = 1 + 0.005 / 3 * rng.standard_normal()
    return q
