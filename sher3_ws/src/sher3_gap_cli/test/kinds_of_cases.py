"""One small case of every kind of machine, with an error that the library knows."""

from __future__ import annotations

from pathlib import Path

import arms
import lifts
import numpy as np
import yaml
from clean_records import cell, circle, late_servo, pendulum, slide
from scipy.constants import g
from scipy.spatial.transform import Rotation


def axes(folder):
    """A slide with dry and viscous friction."""
    described, record = slide(seconds=6.0)
    return described, record.columns


def servo(folder):
    """A position servo that follows its reference by a lag of 60 ms; no force was recorded."""
    t = np.arange(0.0, 12.0, 0.01)
    asked, out = 0.3 * np.sin(1.3 * t) + 0.1 * np.sin(4.1 * t), np.zeros_like(t)
    for k in range(1, len(t)):
        out[k] = out[k - 1] + 0.01 / 0.06 * (asked[k] - out[k - 1])
    signals = {name: {"column": name, "unit": "rad"} for name in ("position", "reference")}
    axis = {
        "name": "pan",
        "motion": "rotary",
        "signals": signals,
        "command_law": {"kind": "position"},
        "encoder_resolution": 1e-4,
    }
    described = {"kind": "axes", "name": "servo", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, {"t": t, "reference": asked, "position": np.round(out, 4)}


def manipulator(folder):
    """A lift with a pendulum, friction on both joints."""
    q, v, a = lifts.motion(seconds=8.0)
    effort = lifts.needed(q, v, a) + lifts.friction(v, coulomb=(6.0, 0.5))
    noisy = effort + 0.02 * np.random.default_rng(3).normal(size=effort.shape)
    described = lifts.described(folder / "lift.urdf").model_dump(mode="json", exclude_unset=True)
    for i, joint in enumerate(described["joints"]):
        joint["signals"] = {x: {"column": f"{x}{i}", "unit": "1"} for x in ("position", "effort")}
    columns = {f"position{i}": np.round(q[:, i], 6) for i in (0, 1)} | {f"effort{i}": noisy[:, i] for i in (0, 1)}
    return described, columns


def load_cell(folder):
    """A load cell with a zero and a wrong gain."""
    described, record = cell()
    return described, record.columns


def force_sensor(folder):
    """A force sensor with a bias under a known load."""
    rng, mass, centre = np.random.default_rng(1), 1.5, np.array([0.01, -0.02, 0.06])
    turn = Rotation.random(120, random_state=1)
    down = turn.inv().apply([0.0, 0.0, -g])
    noise = rng.normal(0.0, np.repeat([0.02, 0.002], 3), (120, 6))
    bias = np.array([1.0, 0.0, 0.5, 0.0, 0.1, 0.0])
    wrench = np.hstack([mass * down, np.cross(mass * centre, down)]) + bias + noise
    described = {
        "kind": "force_sensor",
        "name": "ft",
        "force": {"column": "f", "unit": "N"},
        "torque": {"column": "t", "unit": "N*m"},
        "orientation": {"quaternion": {"column": "q", "unit": "1"}},
        "load": {"mass": mass, "centre": centre.tolist()},
    }
    return described, {"f": wrench[:, :3], "t": wrench[:, 3:], "q": turn.as_quat()}


def positioning(folder):
    """A positioning test with a lead error."""
    targets = np.linspace(0.0, 0.5, 11)
    target = np.tile(np.concatenate([targets, targets[::-1]]), 5)
    reading = target + 2e-5 * (target - 0.25) + np.random.default_rng(1).normal(0.0, 0.3e-6, len(target))
    axis = {"name": "x", **{x: {"column": x, "unit": "m"} for x in ("target", "reading")}}
    return {"kind": "positioning", "name": "test", "axes": [axis]}, {"target": target, "reading": reading}


def arm(folder):
    """Poses of an arm whose second joint reads too much."""
    data = arms.measured(np.array([0.0, 0.004, 0.0, 0.0, 0.0, 0.0]), n=40)
    return arms.described().model_dump(mode="json", exclude_unset=True), {"x": data["joints"], "p": data["poses"]}


def target(folder):
    """The same arm, of which a tracker sees one target."""
    described, data = arm(folder)
    del described["poses"]
    return {**described, "positions": {"column": "p", "unit": "m"}}, {**data, "p": data["p"][:, :3, 3]}


def cable(folder):
    """The same arm, of which one cable from the base of the tracker is seen."""
    described, data = target(folder)
    described["lengths"] = described.pop("positions")
    return described, {**data, "p": np.linalg.norm(data["p"], axis=1)}


def weights(folder):
    """A force sensor with a bias under weights at levers."""
    described, _ = force_sensor(folder)
    for name in ("orientation", "load"):
        del described[name]
    rng = np.random.default_rng(2)
    lever, along = rng.uniform(-0.1, 0.1, (120, 3)), rng.normal(size=(120, 3))
    force = rng.choice([0.0, 10.0, 20.0], 120)[:, None] * along / np.linalg.norm(along, axis=1, keepdims=True)
    vectors = {name: {"column": name, "unit": unit} for name, unit in (("direction", "1"), ("lever", "m"))}
    described["applied"] = {"weight": {"column": "weight", "unit": "N"}, **vectors}
    bias = np.array([1.0, 0.0, 0.5, 0.0, 0.1, 0.0])
    noise = bias + rng.normal(0.0, np.repeat([0.02, 0.002], 3), (120, 6))
    read = {"f": force + noise[:, :3], "t": np.cross(lever, force) + noise[:, 3:]}
    return described, {**read, "weight": np.linalg.norm(force, axis=1), "direction": along, "lever": lever}


def two_encoders(folder):
    """A servo that lags, with play between its encoders."""
    described, record = late_servo()
    return described, {name: x[:4000:2] for name, x in record.columns.items()}


def let_go(folder):
    """A pendulum that dry friction brings to rest."""
    described, record = pendulum()
    return described, record.columns


def ring(folder):
    """A circle of two axes that are out of square."""
    described, record = circle()
    return described, record.columns


TABLES = (load_cell, force_sensor, weights, positioning, arm, target, cable, ring)
KINDS = {f.__name__: f for f in (axes, servo, two_encoders, let_go, manipulator, *TABLES)}


TELLING = {
    "f": "force",
    "q": "quat",
    ("t", "force_sensor"): "torque",
    ("force", "load_cell"): "applied force",
    "read": "reading",
}
"""Column of a case -> name that a person would give it, of any kind or of one."""


def table_of(kind: str, folder: Path) -> tuple[Path, dict]:
    """Write the columns of a kind as a CSV as a person would; return the file, and the description it stands for."""
    described, columns = KINDS[kind](folder)
    flat = {}
    for name, x in columns.items():
        told = TELLING.get((name, kind), TELLING.get(name, name))
        rows = np.asarray(x).reshape(len(x), -1)
        flat |= {f"{told}_{i}" if rows.shape[1] > 1 else told: rows[:, i] for i in range(rows.shape[1])}
    file = folder / "table.csv"
    np.savetxt(file, np.stack(list(flat.values()), 1), "%.9g", ",", header=",".join(flat), comments="")
    return file, described


def written(kind: str, folder: Path) -> tuple[Path, Path]:
    """Write data and description of a kind into a folder; return both files."""
    described, columns = KINDS[kind](folder)
    np.savez(folder / "run.npz", **columns)
    (folder / "machine.yaml").write_text(yaml.safe_dump(described))
    return folder / "run.npz", folder / "machine.yaml"
