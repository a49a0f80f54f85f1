"""Speed and accuracy of the kinematics: scalar calls as the control loop makes them, batches, round trips.

python bench/kinematics.py [--json] [--poses N]

Times are the best of several repeats, because anything else running on the machine only ever adds to them.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin
from sher3_common.compiled import compiled_ieee
from sher3_description import load_robot
from sher3_kinematics import InverseVelocity, RobotKinematics
from sher3_kinematics.arm import whole_robot_model
from sher3_kinematics.kernel import batch as batch
from sher3_kinematics.kernel.robot import pose_inverse_into, tip_jacobian_into, tip_pose_into
from sher3_kinematics.tip_deflection import TipDeflection

SCALAR_LIMIT_US = 1.5
BATCH_LIMIT_MPS = 25.0


def best_seconds(call: Callable[[], object], count: int, repeats: int = 15) -> float:
    """Return the least time [s] of one call over several repeats of `count` calls."""
    call()
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        for _ in range(count):
            call()
        best = min(best, (time.perf_counter() - start) / count)
    return best


def scalar_figures(kinematics: RobotKinematics) -> dict[str, float]:
    """Return microseconds per Python call, checks of the arguments and limits included."""
    q = np.array([0.01, -0.005, 0.02, 0.3, 0.01])
    transform = kinematics.transform_tip_to_base(q)
    tip, axis, centre = transform[:3, 3].copy(), -transform[:3, 2], np.array([0.0, 0.0, 0.06])
    velocity, twist, rest = InverseVelocity(kinematics), np.full(6, 0.001), np.zeros(5)
    deflection, wrench = TipDeflection(kinematics.robot), np.array([0.5, 1.0, -0.5, 0.0, 0.0, 0.0])
    model = whole_robot_model(kinematics.robot)
    data, frame = model.createData(), model.getFrameId("t")
    x, aligned = pin.neutral(model), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    calls: dict[str, Callable[[], object]] = {
        "tip pose": lambda: kinematics.transform_tip_to_base(q),
        "pose inverse": lambda: kinematics.inverse(tip, axis),
        "tip Jacobian": lambda: kinematics.jacobian(q),
        "inverse velocity with limits": lambda: velocity(q, twist, rest),
        "tip deflection under a wrench": lambda: deflection(q, wrench),
        "delta forward": lambda: kinematics.delta.forward(q[:3]),
        "delta inverse": lambda: kinematics.delta.inverse(centre),
        "Pinocchio, same tree: frame Jacobian": lambda: pin.computeFrameJacobian(model, data, x, frame, aligned),
    }
    return {name: best_seconds(call, 200, 200) * 1e6 for name, call in calls.items()}


def batch_figures(kinematics: RobotKinematics, q: np.ndarray) -> dict[str, float]:
    """Return million poses per second on one core."""
    p = kinematics.parameters
    sliders = np.ascontiguousarray(q[:, :3])
    centres = batch.delta_forward_batch(p, sliders)
    rotations, positions = batch.tip_pose_batch(p, q)
    axes = np.ascontiguousarray(-rotations[:, :, 2])
    calls: dict[str, Callable[[], object]] = {
        "delta forward": lambda: batch.delta_forward_batch(p, sliders),
        "delta inverse": lambda: batch.delta_inverse_batch(p, centres),
        "tip pose": lambda: batch.tip_pose_batch(p, q),
        "pose inverse": lambda: batch.pose_inverse_batch(p, positions, axes),
        "tip Jacobian": lambda: batch.tip_jacobian_batch(p, q),
    }
    return {name: len(q) / best_seconds(call, 3) / 1e6 for name, call in calls.items()}


@compiled_ieee
def _poses(p, q, rotations, positions):
    for i in range(len(q)):
        tip_pose_into(p, q[i], rotations[i], positions[i])


@compiled_ieee
def _inverses(p, positions, axes, q):
    for i in range(len(q)):
        pose_inverse_into(p, positions[i, 0], positions[i, 1], positions[i, 2], axes[i], q[i])


@compiled_ieee
def _jacobians(p, q, jacobians):
    for i in range(len(q)):
        tip_jacobian_into(p, q[i], jacobians[i])


def one_by_one(kinematics: RobotKinematics, q: np.ndarray) -> dict[str, float]:
    """Return nanoseconds per pose of compiled loops that compute pose by pose: the peer of the batches."""
    p, n = kinematics.parameters, len(q)
    rotations, positions, jacobians, back = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 6, 5)), np.empty((n, 5))
    _poses(p, q, rotations, positions)
    axes = np.ascontiguousarray(-rotations[:, :, 2])
    calls: dict[str, Callable[[], object]] = {
        "tip pose": lambda: _poses(p, q, rotations, positions),
        "pose inverse": lambda: _inverses(p, positions, axes, back),
        "tip Jacobian": lambda: _jacobians(p, q, jacobians),
    }
    return {name: best_seconds(call, 3) / n * 1e9 for name, call in calls.items()}


def library_solves() -> float:
    """Return microseconds of the two 6 x 6 solutions of a deflection in NumPy: its peer."""
    rng = np.random.default_rng(0)
    matrix, load = rng.standard_normal((6, 6)), rng.standard_normal(6)
    return best_seconds(lambda: np.linalg.solve(matrix.T, np.linalg.solve(matrix, load)), 200, 200) * 1e6


def accuracy_figures(kinematics: RobotKinematics, q: np.ndarray) -> dict[str, float]:
    """Return the largest round-trip error [m, rad] over the workspace."""
    least = kinematics.delta.least_elevation
    inside = np.array([kinematics.singularity_distance(row).distance >= least for row in q])
    good = np.ascontiguousarray(q[inside])
    rotations, positions = kinematics.transform_tip_to_base_batch(good)
    back = kinematics.inverse_batch(positions, np.ascontiguousarray(-rotations[:, :, 2]))
    return {"poses": float(len(good)), "largest round-trip error [m, rad]": float(np.abs(back - good).max())}


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--poses", type=int, default=20_000, help="poses per batch")
    arguments = parser.parse_args()
    kinematics = RobotKinematics(load_robot())
    q = np.random.default_rng(0).uniform(kinematics.lower, kinematics.upper, (max(arguments.poses, 1), 5))
    figures = {
        "scalar_us": scalar_figures(kinematics),
        "batch_million_per_s": batch_figures(kinematics, q),
        "one_by_one_ns": one_by_one(kinematics, q),
        "library_us": library_solves(),
        "accuracy": accuracy_figures(kinematics, q),
    }
    if arguments.json:
        print(json.dumps(figures, indent=2))
        return
    print(f"scalar call from Python [us], target <= {SCALAR_LIMIT_US:g}")
    for name, value in figures["scalar_us"].items():
        print(f"  {name:40s} {value:8.2f}")
    print(f"batch of {len(q)} poses on one core [million/s], target >= {BATCH_LIMIT_MPS:g}")
    for name, value in figures["batch_million_per_s"].items():
        print(f"  {name:40s} {value:8.1f}")
    print("accuracy")
    for name, value in figures["accuracy"].items():
        print(f"  {name:40s} {value:8.3g}")


if __name__ == "__main__":
    main()
