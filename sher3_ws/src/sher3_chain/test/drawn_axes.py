"""Axes and servos with three to six causes drawn at once, by an integrator and a friction law of their own.

The friction sticks and slips (Karnopp): in a band about standstill it holds what is needed, beyond it slides. Steps are
of Heun. The diagnosis knows neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription
from sher3_chain.joint.record import AxesRun
from sher3_common.compiled import compiled

DRIVE, FINE = 1e-3, 20
"""Period of the drive, s, and steps of the integration in it."""
STICKS = 1e-3
"""Share of the top speed within which friction holds the axis."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """A machine, its record and what is true of it: effect id -> parameter -> value (empty: only the id counts).

    How late the effort is read or the reference acts, s, and the speed at which friction has fallen, 0 for neither.
    """

    machine: Axes
    run: AxesRun
    truth: Mapping[str, Mapping[str, float]]
    kind: str
    late: float = 0.0
    falls: float = 0.0


@compiled
def force_at(q, v, driving, law, band):
    """Return what accelerates: the driving force less weight, spring, viscous and dry friction (Karnopp)."""
    mass, coulomb, viscous, offset, arm, spring, extra, stribeck = law
    net = driving - offset - arm * np.sin(q) - spring * q - viscous * v
    level = coulomb + extra * np.exp(-((v / stribeck) ** 2))
    if abs(v) < band and abs(net) < coulomb + extra:
        return -mass * v / 1e-3  # held: what speed there is dies out
    way = np.sign(v) if abs(v) >= band else np.sign(net)
    return net - way * level


@compiled
def played(reference, period, fine, law, gains, band, count, gain):
    """Rows (n, 2) of position and force of a controller: effort = kp (r - q) - kd v; its force is gain times that.

    A servo has no gain of its own to be told: it is the same loop, of which only the position is recorded.
    """
    out = np.empty((len(reference), 2))
    q, v, h = reference[0], 0.0, period / fine
    for k in range(len(reference)):
        effort = gains[0] * (reference[k] - q) - gains[1] * v
        out[k, 0], out[k, 1] = count * np.round(q / count), effort
        for _ in range(fine):
            a = force_at(q, v, gain * effort, law, band) / law[0]
            b = force_at(q + h * v, v + h * a, gain * effort, law, band) / law[0]
            q, v = q + h * v + 0.5 * h * h * a, v + 0.5 * h * (a + b)
    return out


def reference_of(rng: np.random.Generator, time: Array, size: float) -> Array:
    """Return three sines, or strokes to and fro with dwells, of a size."""
    if rng.random() < 0.5:
        pitch = rng.uniform((0.15, 0.5, 1.2), (0.4, 1.0, 2.2))
        sizes = size * np.array([1.0, 0.35, 0.08])
        return np.sum(sizes[:, None] * np.sin(2 * np.pi * pitch[:, None] * time + rng.uniform(0, 6, (3, 1))), axis=0)
    times, places = [0.0], [0.0]
    while times[-1] < time[-1] + 3.0:
        go, rest = rng.uniform(0.5, 1.6), rng.uniform(0.05, 0.4)
        times += [times[-1] + go, times[-1] + go + rest]
        places += 2 * [float(rng.uniform(-1.0, 1.0)) * size]
    width = round(0.25 / (time[1] - time[0]))
    smooth = np.hanning(width + 2)[1:-1]
    return np.convolve(np.interp(time, times, places), smooth / smooth.sum(), "same")


def drawn_axis(seed: int, motion: int = 0, faster: float = 1.0, carried: float = 0.0) -> Drawn:
    """Return an axis under a position controller whose force is recorded.

    The same axis is recorded in another motion, of other pace and size, where `motion` is not 0; in the same motion
    `faster`; or with a known mass on it, `carried` times its own.
    """
    rng = np.random.default_rng([seed, 1])
    rotary = bool(rng.random() < 0.5)
    size = float(rng.uniform(0.5, 1.5)) if rotary else float(rng.uniform(0.03, 0.3))
    mass = float(10 ** rng.uniform(-2.0, 0.0)) if rotary else float(10 ** rng.uniform(0.3, 1.7))
    time = np.arange(0.0, rng.uniform(10.0, 30.0), DRIVE)
    reference = reference_of(rng, time, size)
    speed = np.gradient(reference, DRIVE)
    scale = mass * float(np.sqrt(np.mean(np.gradient(speed, DRIVE) ** 2)))
    top = float(np.abs(speed).max())
    pool = ["coulomb_friction", "viscous_friction", "gravity_load", "payload_mass", "sensor_delay", "stribeck_friction"]
    pool += ["torque_constant"] if rotary else ["spring_torque"]
    share = np.array([4.0, 4.0, 3.0, 2.0, 1.0, 1.5, 1.5])
    chosen = set(rng.choice(pool, int(rng.integers(3, 7)), replace=False, p=share / share.sum()).tolist())
    chosen -= {"payload_mass"} if "torque_constant" in chosen else set()  # one in place of the other
    if "stribeck_friction" in chosen:
        chosen.discard("coulomb_friction")

    def much(name: str, least: float = 0.25, most: float = 1.5) -> float:
        drawn = float(rng.uniform(least, most))  # drawn in any case, so that one cause moves no other
        return drawn * scale if name in chosen else 0.0

    dry, thick = much("coulomb_friction"), much("viscous_friction") / (0.5 * top)
    stribeck, extra = much("stribeck_friction", 0.5), float(rng.uniform(0.4, 0.8))
    weight, gain = much("gravity_load"), 1.0 + float(rng.choice([-1.0, 1.0]) * rng.uniform(0.06, 0.2))
    arm = rotary and ("torque_constant" in chosen or bool(rng.random() < 0.5))
    spring = much("spring_torque") / size
    more = float(rng.uniform(0.1, 0.5)) * mass if "payload_mass" in chosen else 0.0
    known = "torque_constant" in chosen  # a gain shows where a weight is known, which no other cause may then change
    chosen -= {"gravity_load"} if known else set()
    weight = float(rng.uniform(0.8, 2.0)) * scale if known else weight
    slow = 0.05 * top
    law = (mass + more, dry + stribeck, thick, 0.0 if arm else weight, weight if arm else 0.0, spring)
    law = (*law, extra * stribeck, slow)
    pace = 2 * np.pi * float(rng.uniform(4.0, 9.0))
    count = float(2 * np.pi / rng.choice([2**14, 2**17, 2**20])) if rotary else float(rng.choice([1e-7, 1e-6, 5e-6]))
    gains = (pace**2 * mass, 1.4 * pace * mass)
    other = np.random.default_rng([seed, 1, motion])
    asked = reference_of(other, time, size * float(other.uniform(0.5, 1.2))) if motion else reference
    asked = np.interp(np.arange(0.0, time[-1] / faster, DRIVE) * faster, time, asked) if faster != 1.0 else asked
    law = (law[0] + carried * mass, *law[1:])
    rows = played(asked, DRIVE, FINE, law, gains, STICKS * top, count, gain if known else 1.0)
    every = int(rng.choice([1, 2, 5, 10]))
    late = int(rng.integers(2, 6)) * every if "sensor_delay" in chosen else 0
    effort = np.concatenate([np.full(late, rows[0, 1]), rows[:, 1]])[: len(rows)]
    effort = effort + rng.normal(0.0, rng.uniform(0.005, 0.03) * scale, len(effort))
    truth: dict[str, dict[str, float]] = {name: {} for name in chosen}
    values = {
        "coulomb_friction": {"force": dry},
        "viscous_friction": {"extra": thick},
        "gravity_load": {"arm": weight} if arm else {"force": weight},
        "payload_mass": {"mass": more},
        "torque_constant": {"relative": gain - 1.0},
        "sensor_delay": {"delay": (late - 0.5) * DRIVE},  # a held force acts half a period after its stamp on average
        "stribeck_friction": {"force": stribeck},
        "spring_torque": {"stiffness": spring},
    }
    truth = {name: values[name] for name in sorted(truth)}
    axis = {
        **axis_with(rotary, count, ("position", "effort")),
        "command_law": {"kind": "force"},
        "mass": (1.0 + carried) * mass,
        "gravity": {"arm": weight if known else 0.0},
    }
    signals = {"position": rows[::every, 0], "effort": effort[::every]}
    lag = truth.get("sensor_delay", {}).get("delay", 0.0)
    falls = slow if "stribeck_friction" in truth else 0.0
    return Drawn(machine_of(axis), AxesRun("run", DRIVE * every, {"axis": signals}), truth, "axis", lag, falls)


def drawn_servo(seed: int) -> Drawn:
    """Return a position servo of which reference and position are recorded; forces are in units of its stiffness."""
    rng = np.random.default_rng([seed, 2])
    rotary = bool(rng.random() < 0.7)
    size = float(rng.uniform(0.4, 1.2)) if rotary else float(rng.uniform(0.03, 0.3))
    every = int(rng.choice([5, 10, 20]))
    period = every * DRIVE
    time = np.arange(0.0, rng.uniform(20.0, 60.0), DRIVE)
    reference = reference_of(rng, time, size)
    top = float(np.abs(np.gradient(reference, DRIVE)).max())
    lag = float(rng.uniform(0.02, 0.12))
    pool = ["coulomb_friction", "gravity_load", "delay"]
    chosen = set(rng.choice(pool, int(rng.integers(2, 4)), replace=False).tolist())
    dry = float(rng.uniform(0.03, 0.12)) * size if "coulomb_friction" in chosen else 0.0
    weight = float(rng.uniform(0.05, 0.2)) * size if "gravity_load" in chosen else 0.0
    arm = rotary and bool(rng.random() < 0.6)
    late = int(rng.integers(1, 6)) * every if "delay" in chosen else 0
    asked = np.concatenate([np.full(late, reference[0]), reference])[: len(reference)]
    mass = float(rng.uniform(0.05, 0.25)) * lag**2  # per unit of stiffness: it hardly rings
    count = size * float(rng.choice([2e-4, 5e-4, 1e-3]))
    law = (mass, dry, lag, 0.0 if arm else weight, weight if arm else 0.0, 0.0, 0.0, 1.0)
    held = np.repeat(asked[::every], every)[: len(asked)]
    rows = played(held, DRIVE, FINE, law, (1.0, 0.0), STICKS * top, count, 1.0)
    acts = {"delay": late * DRIVE + 0.5 * period} if late else {}  # what is held acts half a period later on average
    truth: dict[str, dict[str, float]] = {"drive_lag": acts}
    truth |= {"coulomb_friction": {"force": dry}} if dry else {}
    truth |= {"gravity_load": {"arm": weight} if arm else {"force": weight}} if weight else {}
    truth |= {"delay": {}} if late else {}
    axis = {**axis_with(rotary, count, ("position", "reference")), "command_law": {"kind": "position"}}
    signals = {"position": rows[::every, 0], "reference": reference[::every]}
    run = AxesRun("run", period, {"axis": signals})
    return Drawn(machine_of(axis), run, truth, "servo", late * DRIVE)


def axis_with(rotary: bool, count: float, names: tuple[str, ...]) -> dict:
    place = "rad" if rotary else "m"
    units = {"position": place, "reference": place, "effort": "N*m" if rotary else "N"}
    return {
        "name": "axis",
        "motion": "rotary" if rotary else "linear",
        "signals": {n: {"column": n, "unit": units[n]} for n in names},
        "encoder_resolution": count,
    }


def machine_of(axis: dict) -> Axes:
    fields = {"kind": "axes", "name": "drawn", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return Axes(AxesDescription.model_validate(fields))
