"""The paper's method on data from the plant: torque-twist loops of many geometries, and deflection compensation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot, load_robot
from sher3_description.contract import GRAVITY
from sher3_effects import plants
from sher3_kinematics import RobotKinematics
from sher3_kinematics.tip_deflection import TipDeflection
from sher3_sim import PlantEffect
from sher3_sim.closed_loop import simulate

from sher3_paper.search.design import Design
from sher3_paper.torsion import PowerFit, fit_power_law, link_deflection, link_force

Floats = NDArray[np.float64]

SETTLE_SECONDS = 0.5
"""Time [s] that the drives get to take up a load: 25 times the 20 ms in which their slowest mode decays."""


def effect(name: str, actuator: str, **parameters: float) -> PlantEffect:
    """Return an effect of the simulator's library by its id."""
    return plants()[name](actuator=actuator, **parameters)


class TwistLoop(NamedTuple):
    """Torque about z [N m] and rotation about z [rad] of one geometry, arrays (n,)."""

    design: Design
    torque: Floats
    rotation: Floats


def twist_loop(design: Design, fraction: float, largest: float = 2.0, steps: int = 40, seed: int = 0) -> TwistLoop:
    """Load the plant with a staircase of moments about z at the tip and read its tracker.

    Args:
        design: geometry of the delta stage.
        fraction: of the link law with springs that the plant's links follow.
        largest: end of the staircase [N m], both signs.
        steps: plateaus; readings are averaged over the second half of each.
        seed: of the tracker's noise.
    """
    robot = design.robot()
    ticks = round(0.2 / robot.control_period)
    torque = largest * np.sin(np.linspace(0.0, 2 * np.pi, steps, endpoint=False))
    wrench = np.zeros((steps * ticks, 6))
    wrench[:, 5] = np.repeat(torque, ticks)
    links = effect("link_compliance", "all", fraction=fraction)
    run = simulate(robot, np.zeros((len(wrench), 5)), wrench, [links], seed)
    tracker = run["tracker/measured_cp"]
    plateau = (tracker.stamp - tracker.stamp[0]) / 1e9 / 0.2
    settled = plateau % 1.0 > 0.5
    number = np.minimum(plateau[settled].astype(int), steps - 1)
    quaternion = tracker.orientation[settled]
    rotation = 2.0 * np.arctan2(quaternion[:, 2], quaternion[:, 3])
    mean = np.array([rotation[number == k].mean() for k in range(steps)])
    return TwistLoop(design, torque, mean)


def identify_from_loops(loops: list[TwistLoop], least: float = 0.2) -> PowerFit:
    """Identify the link law from torque-twist data, as the paper does: every reading becomes a link point.

    Readings below `least` times the largest torque of their loop are left out: noise decides the sign of a logarithm.
    """
    forces, deflections = [], []
    for loop in loops:
        used = np.abs(loop.torque) >= least * np.abs(loop.torque).max()
        width, slope = np.array(loop.design.leg_width), np.array(loop.design.leg_offset() / loop.design.link_length)
        centred = loop.rotation - loop.rotation.mean()
        forces.append(link_force(np.abs(loop.torque[used]), width, slope))
        deflections.append(link_deflection(np.abs(centred[used]), width, slope))
    return fit_power_law(np.concatenate(forces), np.concatenate(deflections))


def measured_wrench_at_tip(robot: Robot, rotation: Floats, measured: Floats) -> Floats:
    """Return the contact wrench (6,) at the tip in {b} from a force sensor reading (6,) in {f}.

    The weight of the tool is removed.

    Args:
        robot: Robot that gives sensor position and tool mass.
        rotation: Rotation (3, 3) of {t}, to which {f} is parallel, in {b}.
        measured: The reading (6,) [N, N m].
    """
    sensor = robot.force_sensor
    weight = rotation.T @ np.array([0.0, 0.0, -sensor.tool_mass * GRAVITY])
    force = measured[:3] - weight
    moment = measured[3:] - np.cross(sensor.tool_com, weight) + np.cross(sensor.position, force)
    return np.concatenate((rotation @ force, rotation @ moment))


@dataclass(frozen=True)
class Compensation:
    """What is left of the tip's deflection when it is compensated, over random poses and hand forces.

    Attributes:
        before, after: tip error [m] without and with compensation (n,).
    """

    before: Floats
    after: Floats

    @property
    def left(self) -> float:
        """Ratio of the root mean squares."""
        return float(np.sqrt((self.after**2).mean() / (self.before**2).mean()))


def compensation(
    links: float = 1.0, structure: float = 1.0, poses: int = 6, force: float = 1.0, seed: int = 1
) -> Compensation:
    """Measure the tip error under hand forces, without and with compensation, on a plant that gives way.

    Each pose is held under a force, then held again with the correction of the model for the measured wrench.

    Args:
        links: Compliance of the plant's delta links over that of the model: 1 is a perfect model, 1.2 a softer robot.
        structure: The same ratio for everything behind the links.
        poses: Number of random poses.
        force: Force of the hand [N], in a random direction.
        seed: Seed of poses, forces and noise.
    """
    robot, rng = load_robot(), np.random.default_rng(seed)
    kinematics, model = RobotKinematics(robot), TipDeflection(robot)
    effects = [
        effect("link_compliance", "all", fraction=links),
        effect("structural_compliance", "tip", fraction=structure),
    ]
    before, after = [], []
    for number in range(poses):
        q = 0.25 * rng.uniform(kinematics.lower, kinematics.upper)
        direction = rng.normal(size=3)
        wrench = np.concatenate((force * direction / np.linalg.norm(direction), np.zeros(3)))
        target = kinematics.transform_tip_to_base(q)
        tip, reading = _hold(robot, q, wrench, effects, seed + number)
        contact = measured_wrench_at_tip(robot, target[:3, :3], reading)
        corrected = kinematics.inverse(model.compensated(q, contact, target[:3, 3]), -target[:3, 2])
        again, _ = _hold(robot, corrected, wrench, effects, seed + number + 1000)
        before.append(np.linalg.norm(tip - target[:3, 3]))
        after.append(np.linalg.norm(again - target[:3, 3]))
    return Compensation(np.array(before), np.array(after))


def _hold(robot: Robot, q: Floats, wrench: Floats, effects: list[PlantEffect], seed: int) -> tuple[Floats, Floats]:
    """Hold a pose under a constant wrench until it has settled.

    Returns:
        The tip position (3,) [m] by the tracker, and the sensor reading (6,).
    """
    ticks = round(2 * SETTLE_SECONDS / robot.control_period)
    run = simulate(robot, np.tile(q, (ticks, 1)), np.tile(wrench, (ticks, 1)), effects, seed)
    tracker, sensor = run["tracker/measured_cp"], run["force/measured_cf"]
    late, settled = len(tracker.stamp) // 2, ticks // 2
    reading = np.concatenate((sensor.force[settled:].mean(axis=0), sensor.torque[settled:].mean(axis=0)))
    return tracker.position[late:].mean(axis=0), reading
