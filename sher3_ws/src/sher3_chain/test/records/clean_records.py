"""Clean records of chains, arms, tables and sensors, each with a description: small machines with known causes."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import lifts
import numpy as np
from nuisances import Record
from scipy.constants import g
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation
from slides import COUNT, KD, KP, MASS, PERIOD, driven

Clean = tuple[dict[str, Any], Record]


def slide(seconds: float = 16.0) -> Clean:
    """A slide under a force, 8 N of dry and 40 N/(m/s) of viscous friction, 500 Hz."""
    rows = driven(seconds, coulomb=8.0, viscous=40.0)
    names = ("position", "reference", "command")
    columns = {"t": np.arange(len(rows)) * PERIOD, **dict(zip(names, rows.T, strict=True))}
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {x: {"column": x, "unit": u} for x, u in zip(names, ("m", "m", "N"), strict=True)},
        "command_law": {"kind": "force", "position_gain": KP, "velocity_gain": KD, "held": True},
        "mass": MASS,
        "encoder_resolution": COUNT,
    }
    described = {"kind": "axes", "name": "slide", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, Record(columns, {"time": "t", **{x: x for x in names}}, {}, {"position": COUNT})


def cell() -> Clean:
    """A load cell of 500 N with a zero of 2 N and a gain 1 % high, noise 0.05 N, three cycles."""
    up = np.arange(0.0, 501.0, 50.0)
    force = np.concatenate([np.tile(np.concatenate([up, up[-2:0:-1]]), 3), [0.0]])
    reading = 2.0 + 1.01 * force + np.random.default_rng(1).normal(0.0, 0.05, len(force))
    described = {
        "kind": "load_cell",
        "name": "cell",
        "applied": {"column": "force", "unit": "N"},
        "reading": {"column": "read", "unit": "N"},
    }
    columns = {"force": force, "read": reading}
    return described, Record(columns, {"applied": "force", "reading": "read"}, {}, {"reading": 0.05})


def screw() -> Clean:
    """A positioning test of a screw, five cycles: 20 um/m of lead error, 6 um lost at a reversal, 0.3 um of noise."""
    there = np.linspace(0.0, 0.5, 11)
    target = np.tile(np.concatenate([there, there[::-1]]), 5)
    side = np.tile(np.repeat([1.0, -1.0], 11), 5)
    noise = np.random.default_rng(1).normal(0.0, 0.3e-6, len(target))
    columns = {"target": target, "reading": target + 20e-6 * (target - 0.25) - 3e-6 * side + noise}
    axis = {"name": "x", **{name: {"column": name, "unit": "m"} for name in columns}}
    return {"kind": "positioning", "name": "screw", "axes": [axis]}, _record(columns, {"reading": 0.3e-6})


def circle() -> Clean:
    """A ring of 0.1 m of two axes that are 50 urad out of square, 0.1 um of noise."""
    angle = np.linspace(0.01, 2 * np.pi + 0.01, 360, endpoint=False)
    noise = np.random.default_rng(3).normal(0.0, 1e-7, (2, 360))
    x, y = 0.1 * np.cos(angle), 0.1 * np.sin(angle)
    columns = {"x": x - 50e-6 * y + noise[0], "y": y + noise[1]}
    plane = {"name": "xy", "radius": 0.1, **{name: {"column": name, "unit": "m"} for name in columns}}
    roles = {"reading": "x", "applied": "y"}
    return {"kind": "positioning", "name": "circle", "planes": [plane]}, Record(columns, roles, {}, {"reading": 1e-7})


def sensor() -> Clean:
    """A force sensor under 1.5 kg in 120 orientations, its forces 3 N and -1 N off zero."""
    rng, turns = np.random.default_rng(1), Rotation.random(120, random_state=1)
    down = turns.inv().apply([0.0, 0.0, -g])
    centre = [0.01, -0.02, 0.06]
    columns = {
        "f": 1.5 * down + [3.0, -1.0, 0.0] + rng.normal(0.0, 0.02, (120, 3)),
        "m": np.cross(1.5 * np.array(centre), down) + rng.normal(0.0, 0.002, (120, 3)),
        "q": turns.as_quat(),
    }
    described = {
        "kind": "force_sensor",
        "name": "sensor",
        "force": {"column": "f", "unit": "N"},
        "torque": {"column": "m", "unit": "N*m"},
        "orientation": {"quaternion": {"column": "q", "unit": "1"}},
        "load": {"mass": 1.5, "centre": centre},
    }
    return described, Record(columns, {"reading": "f", "applied": "m"}, {}, {"reading": 0.02})


def late_servo() -> Clean:
    """A servo that follows with a lag of 40 ms, and 2 mrad of play between its encoders; 500 Hz, 16 s."""
    t = np.arange(0.0, 16.0, PERIOD)
    asked = 0.4 * np.sin(0.9 * t) + 0.1 * np.sin(2.7 * t)
    share = 1.0 - np.exp(-PERIOD / 0.04)
    turned = lfilter([share], [1.0, share - 1.0], asked)
    load = turned.copy()
    for k in range(1, len(t)):
        load[k] = min(max(load[k - 1], turned[k] - 1e-3), turned[k] + 1e-3)
    return _servo("servo", t, asked, turned, load)


def sprung_servo() -> Clean:
    """A held servo on whose gear of 500 N m/rad up to 5 N m are hung; 500 Hz, 16 s."""
    t = np.arange(0.0, 16.0, PERIOD)
    asked, hung = 0.4 * np.sin(0.9 * t), 5.0 * np.round(np.sin(0.5 * t))
    return _servo("spring", t, asked, asked, asked + hung / 500.0, applied=hung)


def _servo(name: str, t: np.ndarray, asked: np.ndarray, turned: np.ndarray, load: np.ndarray, **more: Any) -> Clean:
    count, units = 1e-5, {"applied": "N*m"}
    columns = {"t": t, "reference": asked, "position": count * np.round(turned / count)}
    columns |= {"load": count * np.round(load / count), **more}
    signals = {x: {"column": x, "unit": units.get(x, "rad")} for x in columns if x != "t"}
    axis = {"name": name, "motion": "rotary", "signals": signals, "command_law": {"kind": "position"}}
    axis["encoder_resolution"] = count
    described = {"kind": "axes", "name": name, "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, _record(columns, {"position": count, "load": count})


def pendulum() -> Clean:
    """A pendulum that is let go and comes to rest by 0.02 N m of dry friction, 100 Hz, 10 s."""
    arm, inertia, dry = 0.345, 0.027, 0.02
    q, v, rows = 1.4, 0.0, []
    for k in range(40_000):
        if k % 40 == 0:
            rows.append(q)
        v += 2.5e-4 * float(-arm * np.sin(q) - dry * np.tanh(v / 1e-3)) / inertia
        q += 2.5e-4 * v
    columns = {"t": 0.01 * np.arange(len(rows)), "position": 1e-4 * np.round(np.array(rows) / 1e-4)}
    axis = {
        "name": "pendulum",
        "motion": "rotary",
        "signals": {"position": {"column": "position", "unit": "rad"}},
        "command_law": {"kind": "none"},
        "mass": "unknown",
        "gravity": {"arm": arm},
        "encoder_resolution": 1e-4,
    }
    described = {"kind": "axes", "name": "pendulum", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, _record(columns, {"position": 1e-4})


def lift() -> Clean:
    """A lift with a pendulum: 6 N and 0.5 N m of dry, 0.2 N m s of viscous friction; nuisances on the pendulum."""
    return _arm()


def late_lift() -> Clean:
    """The same lift; the second encoder of its pendulum is 4 ms late."""
    return _arm(late=0.004)


def _arm(late: float | None = None) -> Clean:
    q, v, a = lifts.motion(16.0)
    effort = lifts.needed(q, v, a) + lifts.friction(v, (6.0, 0.5), (0.0, 0.2))
    effort += 0.02 * np.random.default_rng(3).normal(size=effort.shape)
    t, count = lifts.PERIOD * np.arange(len(q)), 1e-6
    columns = {"t": t, "q0": q[:, 0], "position": q[:, 1], "e0": effort[:, 0], "effort": effort[:, 1]}
    swings = {"position": {"column": "position", "unit": "rad"}, "effort": {"column": "effort", "unit": "N*m"}}
    if late is not None:
        columns["load"] = np.interp(t - late, t, q[:, 1])
        swings["load"] = {"column": "load", "unit": "rad"}
    for name in ("q0", "position", "load"):
        columns |= {name: count * np.round(columns[name] / count)} if name in columns else {}
    lifted = {"position": {"column": "q0", "unit": "m"}, "effort": {"column": "e0", "unit": "N"}}
    model = Path(tempfile.mkdtemp()) / "lift.urdf"
    model.write_text(lifts.URDF)
    joints = [
        {"name": "lift", "motion": "linear", "signals": lifted, "encoder_resolution": count},
        {
            "name": "swing",
            "motion": "rotary",
            "signals": swings,
            "encoder_resolution": count,
            "effort_resolution": 0.01,
        },
    ]
    described = {"kind": "manipulator", "name": "lift", "model": str(model), "joints": joints}
    described["time"] = {"column": "t", "unit": "s"}
    return described, _record(columns, {"position": count, "load": count, "effort": 0.01})


def _record(columns: Mapping[str, np.ndarray], counts: Mapping[str, float]) -> Record:
    """A record whose columns are named as their roles."""
    roles = {"t": "time", "target": "applied"}
    known = {roles.get(x, x): x for x in columns}
    return Record(columns, known, {}, counts)


RECORDS: Mapping[str, Callable[[], Clean]] = {
    f.__name__: f for f in (cell, slide, screw, circle, sensor, late_servo, sprung_servo, pendulum, lift, late_lift)
}
"""Every clean record by its name."""
