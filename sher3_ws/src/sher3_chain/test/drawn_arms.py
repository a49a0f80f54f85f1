"""Healthy arms of MuJoCo with drawn losses, drives and integrators, and what a log of them holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from sher3_chain.manipulator.bodies import bodies_of
from sher3_chain.manipulator.identification.inertias import LINK, ROTOR

NAMES = ("turn", "shoulder", "elbow", "wrist")
AXES = ("0 0 1", "0 1 0", "0 1 0", "0 1 0")
METHODS = ("Euler", "implicit", "implicitfast", "RK4")
"""Integrators of MuJoCo."""
SECONDS, NOISE = 16.0, 1e-5
"""Length of a log, s, and noise of its encoders, rad."""


@dataclass(frozen=True)
class Logged:
    """A log, a row for each step or some: `time` (n,), `ctrl`, `qpos`, `qvel`, `actuator_force` (n, k), the model."""

    xml: str
    time: NDArray[np.float64]
    ctrl: NDArray[np.float64]
    qpos: NDArray[np.float64]
    qvel: NDArray[np.float64]
    actuator_force: NDArray[np.float64]


def drawn_xml(
    rng: np.random.Generator, servo: bool = True, joints: int | None = None, methods: Sequence[str] = METHODS
) -> str:
    """Return an arm of two to four joints with drawn masses, losses, rotors, drives and integrator."""
    k = int(rng.integers(2, 5)) if joints is None else joints
    method, step = rng.choice(methods), rng.choice([0.001, 0.002])
    links = [_link(rng, i) for i in range(k)]
    bodies = "".join(f'<body pos="0.3 0 0" gravcomp="{rng.choice([0, 0, 0, 1])}">{link}' for link in links)
    drives = [_drive(rng, i, servo) for i in range(k)]
    return (
        f'<mujoco><option timestep="{step}" integrator="{method}"/><worldbody>{bodies}{"</body>" * k}</worldbody>'
        f"<actuator>{''.join(drives)}</actuator></mujoco>"
    )


def _link(rng: np.random.Generator, i: int) -> str:
    """Return a joint with its losses, a rotor and sometimes a spring, and the link behind it."""
    size = 0.5**i
    losses = {
        "damping": rng.uniform(0.0, 2.0),
        "frictionloss": rng.choice([0.0, 1.0]) * rng.uniform(0.2, 1.0),
        "armature": rng.uniform(0.005, 0.05),
        "stiffness": rng.choice([0.0, 0.0, 0.0, 3.0]),
    }
    words = " ".join(f'{name}="{size * x:.4g}"' for name, x in losses.items())
    mass = rng.uniform(1.0, 4.0) * size
    shape = f'fromto="0 0 0 {rng.uniform(0.2, 0.4):.3g} 0 0" size="0.03" mass="{mass:.3g}"'
    link = (
        f'<joint name="{NAMES[i]}" axis="{AXES[i]}" {words}/><geom type="capsule" {shape} contype="0" conaffinity="0"/>'
    )
    return link


def _drive(rng: np.random.Generator, i: int, servo: bool) -> str:
    gear, stiff = rng.choice([1.0, 1.0, -1.0, 3.0]), rng.uniform(200.0, 600.0) * 0.5**i
    if not servo:
        return f'<motor joint="{NAMES[i]}" gear="{gear}"/>'
    kp = stiff / gear**2
    return f'<position joint="{NAMES[i]}" kp="{kp:.4g}" kv="{rng.uniform(0.03, 0.06) * kp:.4g}" gear="{gear}"/>'


def rough(rng: np.random.Generator, joints: int = 3) -> tuple[str, mujoco.MjSpec]:
    """Return the MJCF of a drawn arm of servos, and one with other links and rotors and 0.8 N m at its last joint."""
    xml = drawn_xml(rng, servo=True, joints=joints).replace('gravcomp="1"', "")
    spec = mujoco.MjSpec.from_string(xml)
    for body in spec.bodies[1:]:
        body.geoms[0].mass *= rng.uniform(0.6, 1.8)
        body.joints[0].armature *= rng.uniform(1.0, 3.0)
    spec.joints[-1].frictionloss += 0.8
    return xml, spec


def beyond(xml: str, spec: mujoco.MjSpec) -> dict[tuple[str, str], float]:
    """Return (place, constant) -> what an arm has of inertia beyond its model, by the names of a verdict."""
    model, real = (bodies_of(text, "arm").tree for text in (xml, spec.to_xml()))
    links = {
        (a.body, name): float(x)
        for a, b in zip(model.links, real.links, strict=True)
        for name, x in zip(LINK, b.own - a.own, strict=True)
    }
    both = zip(model.names, model.links, real.links, strict=True)
    return links | {(name, ROTOR): b.rotor - a.rotor for name, a, b in both}


def asked(rng: np.random.Generator, stamps: NDArray[np.float64], k: int) -> NDArray[np.float64]:
    """Return places (n, k) along drawn sines, rad, which begin at zero."""
    pace, phase = rng.uniform(0.15, 0.9, (k, 3)), rng.uniform(0.0, 2.0 * np.pi, (k, 3))
    sines = 0.35 * np.sin(2.0 * np.pi * pace * stamps[:, None, None] + phase).sum(axis=2)
    return np.asarray(sines * np.minimum(1.0, stamps)[:, None])


def served(
    model: mujoco.MjModel,
    ctrl: NDArray[np.float64],
    place: int = 0,
    late: int = 0,
    push: Callable[[mujoco.MjData], float] = lambda _: 0.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions and forces of the drives, (n, k) each, of servos that follow controls (n, k).

    The servo at `place` follows some steps late, and its joint is pushed besides, N m.
    """
    data, rows = mujoco.MjData(model), []
    for i, now in enumerate(ctrl):
        data.ctrl[:] = now
        data.ctrl[place] = ctrl[max(0, i - late), place]
        mujoco.mj_forward(model, data)
        rows.append([data.qpos.copy(), data.actuator_force[: model.nu].copy()])
        data.qfrc_applied[place] = push(data)
        mujoco.mj_step(model, data)
    table = np.array(rows)
    return table[:, 0], table[:, 1]


def log_of_servos(model: mujoco.MjModel, rng: np.random.Generator, seconds: float) -> dict[str, NDArray[np.float64]]:
    """Return what a log of servos along drawn sines holds, by the names that `gap.diagnose` knows."""
    stamps = np.arange(round(seconds / model.opt.timestep)) * model.opt.timestep
    ctrl = asked(rng, stamps, model.nu) * model.actuator_gear[:, 0]
    qpos, force = served(model, ctrl)
    noisy = qpos + NOISE * rng.standard_normal(qpos.shape)
    return {"time": stamps, "ctrl": ctrl, "qpos": noisy, "actuator_force": force}


def logged(xml: str, seed: int, steps: int = 1) -> Logged:
    """Run a model along drawn sines and return its log, a row every `steps` in which controls hold.

    Motors are driven by a PD law outside the model.
    """
    model = mujoco.MjModel.from_xml_string(xml)
    data, rng, k = mujoco.MjData(model), np.random.default_rng(seed), model.nu
    gear = model.actuator_gear[:, 0]
    servo = model.actuator_biastype[0] == mujoco.mjtBias.mjBIAS_AFFINE
    stiff = 300.0 * 0.5 ** np.arange(k)
    rows = []
    period = steps * model.opt.timestep
    for place in asked(rng, np.arange(round(SECONDS / period)) * period, k):
        data.ctrl[:] = place * gear if servo else (stiff * (place - data.qpos) - 0.05 * stiff * data.qvel) / gear
        mujoco.mj_forward(model, data)
        rows.append([data.time, *data.ctrl, *data.qpos, *data.qvel, *data.actuator_force])
        mujoco.mj_step(model, data, steps)
    all_rows = np.array(rows)
    parts = [all_rows[:, 1 + i * k : 1 + (i + 1) * k] for i in range(4)]
    parts[1] = parts[1] + NOISE * rng.standard_normal(parts[1].shape)
    return Logged(xml, all_rows[:, 0], *parts)
