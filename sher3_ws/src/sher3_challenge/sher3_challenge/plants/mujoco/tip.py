"""Where the tip really is: the mechanism at its temperature, and what gives way under load, moved by MuJoCo."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_description import Robot

from sher3_challenge.plants.mujoco.axes.mjcf import RUB, tendon
from sher3_challenge.plants.mujoco.axes.parts import Array
from sher3_challenge.plants.mujoco.engine import mujoco
from sher3_challenge.plants.mujoco.mechanism import arm, grown, link_tension, platform, tilt_angle
from sher3_challenge.plants.mujoco.rig import Mechanism, Spring, Yielding

ALONG_X, PITCH, YAW = 15e-6, 244.0, 213.0
"""The lumped model of the arm: compliance along x at P [m/N], stiffness about y and z [N m/rad] (the paper)."""
SUBSTEPS = 10
SEATED = 0.02  # N at which a ball joint's power law begins to bend


def follow(
    robot: Robot, m: Mechanism, y: Yielding, legs: Array, contact: Array, kelvin: Array
) -> tuple[Array, Rotation]:
    """Return tip positions (n, 3) and rotations in the tracker's frame.

    Args:
        robot: nominal robot, for the law of the links and the period.
        m: the mechanism.
        y: what gives way.
        legs: (n, 5) positions at the mechanism.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature of the mechanism above its reference; its mean over the run is what counts.
    """
    warm = grown(m, float(np.mean(kelvin)))
    pose = platform(warm, legs[:, :3])
    angle = tilt_angle(warm, legs[:, 4])
    tip, turn = arm(warm, pose, legs[:, 3], angle)
    if y.links > 0.0 and contact.any():
        change = link_change(
            robot, y.links, link_tension(warm, pose, legs, contact, np.cross(tip - pose[:, :3], contact))
        )
        pose = platform(warm, legs[:, :3], change)
        tip, turn = arm(warm, pose, legs[:, 3], angle)
    tip, turn = deflected(y, robot.control_period, pose, tip, turn, contact)
    base = Rotation.from_rotvec(m.base_turn)
    return base.apply(tip) + m.base_shift, base * turn


def link_change(robot: Robot, fraction: float, tension: Array) -> Array:
    """Return (n, 6) what the links grow by: the published power law, seated by a small preload."""
    law = robot.delta.link_compliance
    size = (np.abs(tension) + SEATED) ** law.b - SEATED**law.b
    return np.asarray(fraction * law.a * robot.delta.spring_factor * np.sign(tension) * size)


def deflected(
    y: Yielding, period: float, pose: Array, tip: Array, turn: Rotation, contact: Array
) -> tuple[Array, Rotation]:
    """Return tip (n, 3) and rotations with every spring of the structure moved by its force."""
    moved = {spring.way: np.zeros(len(tip)) for spring in y.springs}
    for spring, x in zip(y.springs, spring_motion(y.springs, period, pose, tip, turn, contact).T, strict=True):
        moved[spring.way] = moved[spring.way] + x
    lever = tip - pose[:, :3]
    moment = np.cross(lever, contact)
    zero = np.zeros(len(tip))
    bend = np.column_stack([
        zero, moved.get("turn_y", zero) + y.healthy * moment[:, 1] / PITCH,
        moved.get("turn_z", zero) + y.healthy * moment[:, 2] / YAW,
    ])  # fmt: skip
    hinge = Rotation.from_rotvec(bend)
    tip = pose[:, :3] + hinge.apply(lever)
    tip[:, 0] += moved.get("x", zero) + y.healthy * ALONG_X * contact[:, 0]
    tip[:, 1] += moved.get("mode_y", zero)
    tip[:, 2] += moved.get("mode_z", zero)
    turn = hinge * turn
    across = np.column_stack([moved.get("across_x", zero), moved.get("across_y", zero), zero])
    slope = y.slope * np.column_stack([across[:, 1], -across[:, 0], zero])
    return tip + turn.apply(across), turn * Rotation.from_rotvec(slope)


def spring_motion(
    springs: tuple[Spring, ...], period: float, pose: Array, tip: Array, turn: Rotation, contact: Array
) -> Array:
    """Return (n, springs) displacements of the masses on the springs, stepped by MuJoCo ten times a tick."""
    if not springs:
        return np.zeros((len(tip), 0))
    moment, local = np.cross(tip - pose[:, :3], contact), turn.apply(contact, inverse=True)
    acceleration = np.gradient(np.gradient(tip, period, axis=0), period, axis=0)
    drives = {"x": contact[:, 0], "turn_y": moment[:, 1], "turn_z": moment[:, 2], "across_x": local[:, 0],
              "across_y": local[:, 1], "mode_y": -acceleration[:, 1], "mode_z": -acceleration[:, 2]}  # fmt: skip
    force = np.column_stack([drives[spring.way] for spring in springs])
    model = mujoco.MjModel.from_xml_string(_springs_mjcf(springs, period / SUBSTEPS))
    data = mujoco.MjData(model)
    data.qpos[:] = [s.compliance * f for s, f in zip(springs, force[0], strict=True)]
    out = np.empty_like(force)
    for k in range(len(force)):
        out[k] = data.qpos
        data.qfrc_applied[:] = force[k]
        mujoco.mj_step(model, data, nstep=SUBSTEPS)
    return out


def _springs_mjcf(springs: tuple[Spring, ...], step: float) -> str:
    bodies = tendons = ""
    for i, s in enumerate(springs):
        stiffness, omega = 1 / s.compliance, 2 * np.pi * s.frequency
        mass = float(stiffness / omega**2)
        damping = float(2 * s.damping * mass * omega)
        rub = f'frictionloss="{s.rub:.15g}" {RUB.format(hard=2 * step)}' if s.rub > 0.0 else ""
        bodies += (
            f'<body gravcomp="1"><joint name="s{i}" type="slide" axis="0 0 1" {rub}/>'
            f'<inertial pos="0 0 0" mass="{mass:.15g}" diaginertia="1e-9 1e-9 1e-9"/></body>'
        )
        tendons += tendon([(f"s{i}", 1.0)], f'stiffness="{stiffness:.15g}" damping="{damping:.15g}" springlength="0"')
    return (
        f'<mujoco model="sher3_structure"><option timestep="{step}" integrator="implicitfast" gravity="0 0 0"/>'
        f'<compiler boundmass="0"/><worldbody>{bodies}</worldbody><tendon>{tendons}</tendon></mujoco>'
    )
