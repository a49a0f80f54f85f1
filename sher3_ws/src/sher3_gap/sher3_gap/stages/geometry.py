"""Kinematic quantities along a recorded run, and how they change when the geometry is not nominal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_common.compiled import compiled
from sher3_description import Robot
from sher3_description.contract import GRAVITY
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import settled
from sher3_kinematics.kernel import (
    KernelParameters,
    gravity_load_into,
    kernel_parameters,
    tip_jacobian_into,
    tip_pose_into,
)
from sher3_kinematics.kernel.batch import delta_forward_batch, tip_quaternion_batch

from sher3_gap.signals import RAMP_LIMIT, RunSignals


@compiled
def _along(p: KernelParameters, q: Array, rotation: Array, position: Array, jacobian: Array, gravity: Array) -> None:
    for k in range(q.shape[0]):
        tip_pose_into(p, q[k], rotation[k], position[k])
        tip_jacobian_into(p, q[k], jacobian[k])
        gravity_load_into(p, q[k], gravity[k])


@compiled
def _poses(p: KernelParameters, q: Array, rotation: Array, position: Array) -> None:
    for k in range(q.shape[0]):
        tip_pose_into(p, q[k], rotation[k], position[k])


@dataclass(frozen=True)
class Path:
    """Nominal kinematics at the residual grid of one run.

    Attributes:
        position: (g, 3) tip in {b}; rotation: (g, 3, 3) R_bt; jacobian: (g, 6, 5); gravity: (g, 5) G(q).
        contact: (g, 3) known force on the tip in {b}; contact_force: (g, 5) J^T W.
        loaded: (g,) a known load is on the tip.
        tool_wrench, contact_wrench: (g, 6) what the sensor reads nominally of the tool's weight and of the
            contact, in {f}; while a load changes, by as much as the reading says it has.
        determined: (g, 6, 6) what the reading tells beside that; None where no load changes.
    """

    position: Array
    rotation: Array
    jacobian: Array
    gravity: Array
    contact: Array
    contact_force: Array
    loaded: np.ndarray
    tool_wrench: Array
    contact_wrench: Array
    determined: Array | None = None

    @property
    def nominal_wrench(self) -> Array:
        """What the force sensor reads nominally, (g, 6) in {f}."""
        return self.tool_wrench + self.contact_wrench


def changing(run: RunSignals) -> tuple[Array, Array]:
    """Return the stated tip loads that come or go at samples of the grid, N in {b}: twice (g, 3), zero where none.

    A share of each acts, which nobody states. Those of one load and the next are two, so that they may overlap.
    """
    clock = run.grid * run.period
    doubtful = ~settled(run.loaded_ok)
    out = np.zeros((2, len(clock), 3))
    for n, (start, stop, *force) in enumerate(run.payload):
        ends = np.minimum(np.abs(clock - start), np.abs(clock - stop))
        out[n % 2][doubtful & (ends <= RAMP_LIMIT)] = force
    return out[0], out[1]


class Geometry:
    """Kinematics of one robot along runs; paths are computed once per run."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._paths: dict[str, Path] = {}

    @cached_property
    def parameters(self) -> KernelParameters:
        """Kernel parameters of the nominal robot."""
        return kernel_parameters(self.robot)

    def path(self, run: RunSignals) -> Path:
        """Kinematics at the residual grid of `run`, from the load encoders (motor encoders where there are none)."""
        if run.name not in self._paths:
            self._paths[run.name] = self._compute(run)
        return self._paths[run.name]

    def positions(self, run: RunSignals) -> Array:
        """Joint positions at the residual grid, (g, 5).

        The reading of the tick, as the tracker's sample belongs to it.
        """
        source = run.motor if run.load is None else run.load
        return np.ascontiguousarray(source[run.grid])

    def _compute(self, run: RunSignals) -> Path:
        q = self.positions(run)
        g = len(q)
        rotation, position = np.empty((g, 3, 3)), np.empty((g, 3))
        jacobian, gravity = np.empty((g, 6, 5)), np.empty((g, 5))
        _along(self.parameters, q, rotation, position, jacobian, gravity)
        contact = np.zeros((g, 3)) if run.contact is None else run.contact[run.grid]
        contact_force = np.einsum("gji,gj->gi", jacobian[:, :3], contact)
        tool, touch = self._wrench(rotation, contact)
        loaded = np.abs(contact).max(axis=1) > 0.0
        determined = None
        directions = [self._wrench(rotation, force)[1] for force in changing(run)]
        if run.wrench is not None and any(d.any() for d in directions):
            share, determined = self._shares(run.to_grid(run.wrench) - tool - touch, np.stack(directions, axis=2))
            touch = touch + share
        return Path(position, rotation, jacobian, gravity, contact, contact_force, loaded, tool, touch, determined)

    def _shares(self, left: Array, directions: Array) -> tuple[Array, Array]:
        """Return the part of a wrench (g, 6) along directions (g, 6, k), and what is left of one, (g, 6, 6)."""
        sensor = self.robot.force_sensor
        scale = np.array([sensor.noise_force] * 3 + [sensor.noise_torque] * 3)
        along = (directions / scale[:, None]) @ np.linalg.pinv(directions / scale[:, None])
        along = along * scale[:, None] / scale
        return np.einsum("gij,gj->gi", along, left), np.eye(6) - along

    def _wrench(self, rotation: Array, contact: Array) -> tuple[Array, Array]:
        sensor = self.robot.force_sensor
        weight = np.array([0.0, 0.0, -sensor.tool_mass * GRAVITY])
        gravity = np.einsum("gji,j->gi", rotation, weight)
        tool = np.hstack([gravity, np.cross(np.array(sensor.tool_com), gravity)])
        force = np.einsum("gji,gj->gi", rotation, contact)
        return tool, np.hstack([force, np.cross(-np.array(sensor.position), force)])

    def platform(self, run: RunSignals) -> Array:
        """Platform centre in {b} at the residual grid, (g, 3)."""
        return delta_forward_batch(self.parameters, self.positions(run))

    def links(self, platform: Array) -> Array:
        """Gamma (g, 6, 6) for platform centres (g, 3): columns (u; b x u), links of leg 1, 2, 3 in pairs."""
        delta = self.robot.delta
        half = 0.5 * delta.leg_width
        inner, spread = delta.platform_distance, delta.leg_offset
        gamma = np.empty((len(platform), 6, 6))
        for k, azimuth in enumerate(delta.leg_azimuth):
            radial = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
            across = platform[:, :2] - spread * radial[:2]
            height = np.sqrt(delta.link_length**2 - (across**2).sum(axis=1))
            u = np.column_stack([across, height]) / delta.link_length
            for side in (0, 1):
                ball = inner * radial + (1 - 2 * side) * half * np.array([-radial[1], radial[0], 0.0])
                gamma[:, :3, 2 * k + side], gamma[:, 3:, 2 * k + side] = u, np.cross(ball, u)
        return gamma

    def poses(self, parameters: KernelParameters, q: Array) -> tuple[Array, Array]:
        """Rotation (g, 3, 3) and position (g, 3) of the tip of a robot with other kernel parameters."""
        rotation, position = np.empty((len(q), 3, 3)), np.empty((len(q), 3))
        _poses(parameters, np.ascontiguousarray(q), rotation, position)
        return rotation, position

    def tip_error(self, run: RunSignals) -> Array:
        """Tracked pose minus nominal pose at its own tick, sorted into the residual grid, (g, 6): position, rotation
        vector in {b}; 0 where no sample.
        """
        assert run.tracker_position is not None and run.tracker_rotation is not None and run.tracker_index is not None
        source = run.motor if run.load is None else run.load
        rotation, position = self.poses(self.parameters, source[run.tracker_index])
        out, slot = np.zeros((len(run.grid), 6)), run.tracker_slot
        out[slot, :3] = run.tracker_position - position
        out[slot, 3:] = turn(tip_quaternion_batch(rotation), run.tracker_rotation)
        return out

    def pose_change(self, run: RunSignals, step: float, **changes: float) -> Array:
        """Derivative of the tip pose along a change of kernel parameters, (g, 6) per unit, by a central difference.

        `changes` gives the direction (d parameter per unit); `step` is the size of the difference in that unit.
        """
        q = self.positions(run)
        sides = []
        for sign in (1.0, -1.0):
            moved = {k: getattr(self.parameters, k) + sign * step * d for k, d in changes.items()}
            sides.append(self.poses(self.parameters._replace(**moved), q))
        (r1, p1), (r0, p0) = sides
        linear = (p1 - p0) / (2.0 * step)
        angular = turn(tip_quaternion_batch(r0), tip_quaternion_batch(r1)) / (2.0 * step)
        return np.hstack([linear, angular])


def turn(before: Array, after: Array) -> Array:
    """Return the rotation vectors (g, 3) in {b} from orientations to others, (g, 4) each: quaternions x y z w."""
    (u, a), (v, b) = ((q[:, :3], q[:, 3:]) for q in (before, after))
    part, whole = a * v - b * u + np.cross(u, v), a * b + np.sum(u * v, axis=1, keepdims=True)
    sine = np.linalg.norm(part, axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, np.abs(whole))
    return np.copysign(1.0, whole) * part * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0.0)
