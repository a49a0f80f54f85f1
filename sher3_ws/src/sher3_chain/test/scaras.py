"""A SCARA for the tests: two turning joints in the plane and a quill, with efforts worked out by hand."""

from pathlib import Path

import numpy as np
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.kind import KIND

NAMES = ("shoulder", "elbow", "quill")
COUNTS = np.array([2e-5, 2e-5, 2e-6])
NOISE = np.array([0.05, 0.03, 0.2])
M1, M2, M3, L1, L2, C1, C2, I1, I2 = 8.0, 4.0, 2.0, 0.3, 0.25, 0.15, 0.12, 0.08, 0.03
"""Masses (kg), lengths and centres (m), inertias about the centres (kg m^2)."""
WAVES = [
    [(0.6, 1.3, 0.0), (0.3, 2.9, 0.4), (0.1, 5.3, 2.0)],
    [(0.7, 1.7, 1.0), (0.3, 3.3, 0.2), (0.1, 6.1, 1.0)],
    [(0.05, 1.9, 0.5), (0.02, 4.1, 0.0)],
]
"""Amplitude, circular frequency and phase of the sines of each joint."""


def _link(name, mass, inertia, at):
    return f"""<link name="{name}"><inertial><origin xyz="{at} 0 0"/><mass value="{mass}"/>
    <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def _joint(name, kind, parent, child, at):
    return f"""<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="{at} 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="500" velocity="9"/></joint>"""


URDF = "\n".join(
    [
        '<robot name="scara"><link name="base"/>',
        _link("upper", M1, I1, C1),
        _link("fore", M2, I2, C2),
        _link("tool", M3, 0.0, 0.0),
        _joint("shoulder", "revolute", "base", "upper", 0.0),
        _joint("elbow", "revolute", "upper", "fore", L1),
        _joint("quill", "prismatic", "fore", "tool", L2),
        "</robot>",
    ]
)


def motion(t):
    """Position, velocity and acceleration, (n, 3) each."""
    q = [sum(a * np.sin(w * t + p) for a, w, p in waves) for waves in WAVES]
    v = [sum(a * w * np.cos(w * t + p) for a, w, p in waves) for waves in WAVES]
    return (
        np.stack(q, 1),
        np.stack(v, 1),
        np.stack([sum(-a * w * w * np.sin(w * t + p) for a, w, p in waves) for waves in WAVES], 1),
    )


def needed(q, v, a):
    """Efforts (n, 3) by Lagrange's equations of two links in the plane; the quill carries its weight."""
    first = I1 + M1 * C1**2 + (M2 + M3) * L1**2
    second = I2 + M2 * C2**2 + M3 * L2**2
    both = L1 * (M2 * C2 + M3 * L2)
    c, s = np.cos(q[:, 1]), np.sin(q[:, 1])
    shoulder = (first + second + 2.0 * both * c) * a[:, 0] + (second + both * c) * a[:, 1]
    shoulder = shoulder - both * s * (2.0 * v[:, 0] * v[:, 1] + v[:, 1] ** 2)
    elbow = (second + both * c) * a[:, 0] + second * a[:, 1] + both * s * v[:, 0] ** 2
    return np.stack([shoulder, elbow, M3 * (9.81 + a[:, 2])], 1)


def record(rate, dry, late=(0.0, 0.0, 0.0), seconds=30.0):
    """A run with dry friction (3,), whose efforts are `late` (3,), s."""
    t, rng = np.arange(0.0, seconds, 1.0 / rate), np.random.default_rng(0)
    efforts = np.empty((len(t), 3))
    for i, delay in enumerate(late):
        q, v, a = motion(t - delay)
        efforts[:, i] = (needed(q, v, a) + np.tanh(v / 1e-3) * dry)[:, i]
    efforts += NOISE * rng.normal(size=efforts.shape)
    read = COUNTS * np.round(motion(t)[0] / COUNTS)
    return AxesRun(
        "run", 1.0 / rate, {n: {"position": read[:, i], "effort": efforts[:, i]} for i, n in enumerate(NAMES)}
    )


def machine(path: Path, rate):
    path.write_text(URDF)
    joints = [
        {
            "name": name,
            "motion": "linear" if name == "quill" else "rotary",
            "signals": {"position": {"column": "q", "unit": "1"}, "effort": {"column": "e", "unit": "1"}},
            "encoder_resolution": float(count),
            "effort_resolution": 0.01,
        }
        for name, count in zip(NAMES, COUNTS, strict=True)
    ]
    data = {"kind": "manipulator", "name": "scara", "model": str(path), "time": {"rate": rate}, "joints": joints}
    return KIND.machine(ManipulatorDescription.model_validate(data))
