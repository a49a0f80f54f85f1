"""The robot as drawn, as built, and as it is on the day: deviations of the amendment's section 1."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from sher3_description import ACTUATORS, Robot

from sher3_challenge.plants.level import Bend, Level
from sher3_challenge.plants.mujoco.axes.laws import Bent, Constant
from sher3_challenge.plants.mujoco.axes.parts import AXES, ROLL, Array, Axis, Host
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric
from sher3_challenge.plants.mujoco.rig import Mechanism, Rig, Sensor, Yielding

MASS, VISCOUS, GRAVITY, TORQUE = 0.01, 0.05, 0.005, 0.002
FRICTION, FRICTION_DAY, CONSTANT = 3e-4, 0.05, 5e-4  # of rated; of itself; of rated
RATIO, RIPPLE, RIPPLE_ROLL = 2e-5, 0.05e-6, 50e-6
BALL, RAIL, LENGTH, TIP_DAY = 0.25e-6, 50e-6, 1e-6, 2e-6
EXPANSION, YIELDING, TOOL_MASS = 0.4e-6, 1e-3, 1e-4
BIAS, MATRIX, KNOWN_LOAD, START = np.repeat([6e-4, 6e-6], 3), 1e-3, 5e-3, 0.5e-6


def within(rng: np.random.Generator, limit: Any, shape: Any = ()) -> Any:
    """Return normal deviations of which `limit` is three standard deviations and the end."""
    return limit * np.clip(rng.standard_normal(shape) / 3, -1, 1)


def as_drawn(robot: Robot) -> Rig:
    """Return the robot exactly as its file says."""
    axes = [
        Axis(a.kind, a.mass, a.viscous, a.drive.kp, a.drive.ki, a.drive.rated, a.lead, hangs=name.startswith("delta"))
        for name, a in zip(ACTUATORS, robot.actuators, strict=True)
    ]
    host = Host(
        np.full(AXES, robot.position_gain),
        np.array([a.limits.velocity for a in robot.actuators]),
        np.array([a.motor_encoder for a in robot.actuators]),
        np.array([a.load_encoder for a in robot.actuators]),
    )
    sensor = robot.force_sensor
    built = Sensor(np.eye(6), np.zeros(6), np.zeros(6), sensor.tool_mass, np.array(sensor.tool_com))
    return Rig(robot, axes, host, _mechanism(robot), Yielding(), built)


def _mechanism(robot: Robot) -> Mechanism:
    delta, arm, tilt = robot.delta, robot.arm, robot.tilt_linkage
    half = delta.leg_width / 2

    def balls(radius: float) -> Array:
        reach = math.sqrt(radius**2 - half**2)
        return np.array(
            [
                [reach * math.cos(a) - side * math.sin(a), reach * math.sin(a) + side * math.cos(a), 0.0]
                for a in delta.leg_azimuth
                for side in (half, -half)
            ]
        )

    return Mechanism(
        balls(delta.base_radius) + np.array([0.0, 0.0, delta.slider_zero]),
        np.tile([0.0, 0.0, 1.0], (3, 1)),
        balls(delta.platform_radius),
        np.full(6, delta.link_length),
        np.array([arm.d1, arm.d2, arm.d3, *arm.tool]),
        np.array([tilt.crank, tilt.coupler, tilt.offset]),
    )


def deviate(rig: Rig, rng: np.random.Generator, level: Level) -> None:
    """Make the robot as drawn the one of a case: every quantity somewhere within its tolerance."""

    def within(limit: Any, shape: Any = ()) -> Any:
        return level.off(rng, limit / 3, shape)

    for j, (axis, actuator) in enumerate(zip(rig.axes, rig.robot.actuators, strict=True)):
        axis.mass *= 1 + within(MASS)
        axis.viscous *= 1 + within(VISCOUS)
        axis.gravity_gain *= 1 + within(GRAVITY)
        axis.torque_gain *= 1 + within(TORQUE)
        axis.coulomb = float(FRICTION * actuator.drive.rated * rng.uniform(0.2, 1.0))
        axis.lead_error = float(within(RATIO))
        ripple = RIPPLE_ROLL if j == ROLL else RIPPLE
        axis.ripples = (Eccentric(float(abs(within(ripple))), actuator.lead, float(rng.uniform(0, 2 * math.pi))),)
    rig.host.edge = rng.uniform(-0.5, 0.5, AXES)
    m = rig.mechanism
    _seat(m, within)
    m.rail = m.rail + within(RAIL, (3, 3)) * [1, 1, 0]
    m.arm = m.arm + within(LENGTH, 6) * [0, 0, 0, 1, 1, 1]
    m.linkage = m.linkage + within(LENGTH, 3)
    m.expansion = float(within(EXPANSION))
    rig.yielding.healthy = float(abs(within(YIELDING)))
    s, sensor = rig.sensor, rig.robot.force_sensor
    reach = np.array([*sensor.range_force, *sensor.range_torque])
    s.matrix = s.matrix + within(MATRIX, (6, 6)) * np.outer(reach, 1 / reach)
    s.bias = s.bias + within(BIAS, 6)
    s.tool_mass += float(within(TOOL_MASS))


def _seat(m: Mechanism, within: Callable[..., Any]) -> None:
    m.rail_ball = m.rail_ball + within(BALL, (6, 3))
    m.platform_ball = m.platform_ball + within(BALL, (6, 3))
    m.link = m.link + within(BALL, 6)


def bend(rig: Rig, how: Bend, friction: Sequence[float]) -> None:
    """Bend the laws of what is no drawing's: transmission and readings, pushes, and friction beyond what is healthy."""
    rig.host.bend = how
    for axis, healthy, numbers in zip(rig.axes, friction, zip(*how, strict=True), strict=True):
        if axis.coulomb > healthy:
            axis.levels += (Constant(axis.coulomb - healthy),)
            axis.coulomb = healthy
        axis.levels = tuple(Bent(law, *map(float, numbers)) for law in axis.levels)
        axis.pushes = tuple(Bent(law, *map(float, numbers)) for law in axis.pushes)


def on_the_day(rig: Rig, rng: np.random.Generator) -> None:
    """Add what changes from run to run."""
    for axis, actuator in zip(rig.axes, rig.robot.actuators, strict=True):
        axis.viscous *= 1 + within(rng, VISCOUS)
        axis.coulomb *= 1 + within(rng, FRICTION_DAY)
        axis.constant += float(within(rng, CONSTANT * actuator.drive.rated))
    counts = np.array([a.load_encoder for a in rig.robot.actuators])
    rig.host.start = within(rng, START / counts[0] * counts, AXES)
    rig.host.edge = rig.host.edge + within(rng, 1.0, AXES)
    _seat(rig.mechanism, partial(within, rng))
    rig.mechanism.base_shift = rig.mechanism.base_shift + within(rng, TIP_DAY, 3)
    rig.known_load = float(1 + within(rng, KNOWN_LOAD))
