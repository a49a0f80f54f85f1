"""A six-axis arm and poses measured of it, for the tests."""

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_static.arm.description import ArmDescription
from sher3_static.arm.kind import KIND, ArmKind
from sher3_static.arm.kinematics import postures, transform
from sher3_static.readings import Readings

HALF = np.pi / 2
ROWS = [(0.0, 0.3, 0.0), (0.0, 0.0, -HALF), (0.25, 0.0, 0.0), (0.05, 0.28, -HALF), (0.0, 0.0, HALF), (0.0, 0.08, -HALF)]
"""a, d (m) and alpha (rad) of the joints."""
Z = transform([0.4, -0.2, 0.1], Rotation.from_euler("xyz", [0.3, -0.2, 1.0]).as_matrix())
X = transform([0.02, 0.05, 0.06], Rotation.from_euler("xyz", [0.1, 0.2, -0.7]).as_matrix())
"""Base in the measuring frame, and measured body on the flange."""


def described(rows=ROWS, **more) -> ArmDescription:
    joints = [{"name": f"j{i + 1}", "a": a, "d": d, "alpha": alpha} for i, (a, d, alpha) in enumerate(rows)]
    column = {"column": "x", "unit": "rad"}
    base = {"kind": "arm", "name": "arm", "joint_positions": column, "poses": {"column": "p", "unit": "m"}}
    return ArmDescription.model_validate({**base, "noise": 2e-4, "joints": joints, **more})


def machine(rows=ROWS, **more) -> ArmKind:
    return KIND.machine(described(rows, **more))


def measured(offsets, n=80, seed=0, noise=2e-4) -> Readings:
    """Poses of the arm whose joints read `offsets` too much."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.2, 1.2, (n, len(ROWS)))
    poses = Z @ postures(machine().known.arm, q - offsets).tip @ X
    poses[:, :3, 3] += noise * rng.normal(size=(n, 3))
    return Readings("run", {"joints": q, "poses": poses})
