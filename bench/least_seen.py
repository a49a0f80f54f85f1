"""Whether what a verdict says it would have seen is seen: healthy drawn machines with one law at exactly that size.

Of each machine every law of the sentence "would have shown" that its plant has is put in, one at a time. It is seen
where there is a gap, and named where it is among the causes or their rivals.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path

import mujoco
import numpy as np
import sher3.gap as gap
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Verdict

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import NAMES, drawn_xml, log_of_servos
from drawn_axes import DRIVE, FINE, STICKS, AxesRun, axis_with, machine_of, played, reference_of

PREFIX = {"G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "p": 1e-12}
SAID = re.compile(r"([A-Za-z][\w ]*?) from ([\d.e+-]+) ([^ ,]+)")
PLACES = ("axis: would have shown", "load cell: would have shown", f"{NAMES[0]}: would have shown")
Machine = Callable[[Mapping[str, float]], Verdict]
"""Law -> size, SI units, at one place: what is answered of the machine with it."""


def least(verdict: Verdict) -> dict[str, float]:
    """Return law -> size from which on it would have shown, SI units, of the axis or of the first joint."""
    note = next((n for n in verdict.notes if n.startswith(PLACES)), "")
    return {law.strip().replace(" ", "_").lower(): float(x) * scale(unit) for law, x, unit in SAID.findall(note)}


def scale(unit: str) -> float:
    """Return one of a printed unit in SI units, its prefix included."""
    plain = {"%": 0.01, "g": 1e-3, "m": 1.0, "rad": 1.0, "s": 1.0, "N": 1.0}
    head = re.split(r"[/·^]", unit)[0]
    return plain[head] if head in plain else PREFIX[head[0]] * plain[head[1:]]


def axis(seed: int) -> Machine:
    """Return an axis under a position controller whose force is recorded."""
    rng = np.random.default_rng([seed, 7])
    rotary = bool(rng.random() < 0.5)
    size, mass = (
        (rng.uniform(0.5, 1.5), 10 ** rng.uniform(-2, 0))
        if rotary
        else (rng.uniform(0.03, 0.3), 10 ** rng.uniform(0.3, 1.7))
    )
    time = np.arange(0.0, rng.uniform(8.0, 15.0), DRIVE)
    reference = reference_of(rng, time, size)
    speed = np.gradient(reference, DRIVE)
    noise = rng.uniform(0.005, 0.03) * mass * np.std(np.gradient(speed, DRIVE))
    pace = 2 * np.pi * rng.uniform(4.0, 9.0)
    count = 2 * np.pi / rng.choice([2**17, 2**20]) if rotary else rng.choice([1e-7, 1e-6])
    every = int(rng.choice([1, 2, 5]))
    errors = rng.normal(0.0, noise, len(time))

    def answered(laws: Mapping[str, float]) -> Verdict:
        names = ("coulomb_friction", "viscous_friction", "gravity_load", "", "spring_torque")
        law = (mass + laws.get("payload_mass", 0.0), *(laws.get(n, 0.0) for n in names), 0.0, 1.0)
        gains = (pace**2 * mass, 1.4 * pace * mass)
        top = STICKS * float(np.abs(speed).max())
        rows = played(reference, DRIVE, FINE, law, gains, top, count, 1.0 + laws.get("torque_constant", 0.0))
        fields = {
            **axis_with(rotary, count, ("position", "effort")),
            "command_law": {"kind": "force"},
            "mass": mass,
        }
        signals = {"position": rows[::every, 0], "effort": (rows[:, 1] + errors)[::every]}
        return diagnose(machine_of(fields), [AxesRun("run", DRIVE * every, {"axis": signals})]).verdict

    return answered


def servo(seed: int) -> Machine:
    """Return a position servo of which reference and position are recorded; it sticks, sags and lags if at all."""
    rng = np.random.default_rng([seed, 8])
    rotary, period = bool(rng.random() < 0.7), float(rng.choice([0.005, 0.01, 0.02]))
    time = np.arange(0.0, rng.uniform(15.0, 40.0), period)
    asked = reference_of(rng, time, float(rng.uniform(0.4, 1.2)) if rotary else float(rng.uniform(0.03, 0.3)))
    count = float(np.ptp(asked)) * rng.choice([1e-4, 3e-4])
    noise = rng.normal(0.0, count, len(time))

    def answered(laws: Mapping[str, float]) -> Verdict:
        q, dry, lag = asked.copy(), laws.get("coulomb_friction", 0.0), laws.get("drive_lag", 0.0)
        if lag:
            q = np.interp(time - lag, time, asked)
        for k in range(1, len(q)) if dry else ():
            q[k] = min(max(q[k - 1], asked[k] - dry), asked[k] + dry)
        read = count * np.round((q - laws.get("gravity_load", 0.0) + noise) / count)
        fields = {**axis_with(rotary, count, ("position", "reference")), "command_law": {"kind": "position"}}
        run = AxesRun("run", period, {"axis": {"position": read, "reference": asked}})
        return diagnose(machine_of(fields), [run]).verdict

    return answered


def arm(seed: int) -> Machine:
    """Return an arm of two to four servos in MuJoCo; the laws are of the first joint."""
    xml = drawn_xml(np.random.default_rng(seed), servo=True, methods=("implicitfast",))

    def answered(laws: Mapping[str, float]) -> Verdict:
        model = mujoco.MjModel.from_xml_string(xml)
        model.dof_frictionloss[0] += laws.get("coulomb_friction", 0.0)
        model.dof_damping[0] += laws.get("viscous_friction", 0.0)
        model.dof_armature[0] += laws.get("rotor_inertia", 0.0)
        return gap.diagnose(xml, log_of_servos(model, np.random.default_rng(seed), 10.0)).verdict

    return answered


def cell(seed: int) -> Machine:
    """Return a load cell of 500 N with noise, three cycles."""
    rng = np.random.default_rng([seed, 9])
    up = np.linspace(0.0, 500.0, int(rng.integers(6, 16)))
    force = np.concatenate([np.tile(np.concatenate([up, up[-2:0:-1]]), 3), [0.0]])
    noise = rng.normal(0.0, rng.uniform(0.02, 0.5), len(force))
    columns = {name: {"column": name, "unit": "N"} for name in ("applied", "reading")}

    def answered(laws: Mapping[str, float]) -> Verdict:
        read = laws.get("force_bias", 0.0) + (1.0 + laws.get("force_scale", 0.0)) * force + noise
        return gap.diagnose(
            {"kind": "load_cell", "name": "cell", **columns}, {"applied": force, "reading": read}
        ).verdict

    return answered


def table(seed: int) -> Machine:
    """Return a positioning test of five cycles."""
    rng = np.random.default_rng([seed, 10])
    there = np.linspace(0.0, rng.uniform(0.1, 1.0), int(rng.integers(6, 21)))
    target, side = np.tile(np.r_[there, there[::-1]], 5), np.tile(np.repeat([1.0, -1.0], len(there)), 5)
    noise = rng.normal(0.0, rng.uniform(0.1e-6, 2e-6), len(target))
    columns = {name: {"column": name, "unit": "m"} for name in ("target", "reading")}

    def answered(laws: Mapping[str, float]) -> Verdict:
        read = target * (1.0 + laws.get("lead_error", 0.0)) - 0.5 * laws.get("backlash", 0.0) * side + noise
        described = {"kind": "positioning", "name": "test", "axes": [{"name": "axis", **columns}]}
        return gap.diagnose(described, {"target": target, "reading": read}).verdict

    return answered


HAS = {
    axis: ("coulomb_friction", "viscous_friction", "gravity_load", "payload_mass", "spring_torque", "torque_constant"),
    servo: ("coulomb_friction", "gravity_load", "drive_lag"),
    cell: ("force_bias", "force_scale"),
    table: ("lead_error", "backlash"),
    arm: ("coulomb_friction", "viscous_friction", "rotor_inertia"),
}
"""Kind of machine -> laws that its plant has."""


def main() -> None:
    """Print what was missed, and the shares seen and named of each kind and law."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", default="axis,servo,arm,cell,table")
    parser.add_argument("--seeds", default="40000:40040", help="FIRST:LAST.")
    asked = parser.parse_args()
    first, last = map(int, asked.seeds.split(":"))
    for kind in (k for k in HAS if k.__name__ in asked.kinds.split(",")):
        seen, named, tried = Counter[str](), Counter[str](), Counter[str]()
        for seed in range(first, last):
            machine = kind(seed)
            healthy = machine({})
            if healthy.status != "no_gap":
                print(f"{kind.__name__} {seed}: healthy is {healthy.status}", flush=True)
                continue
            for law, size in least(healthy).items():
                if law not in HAS[kind]:
                    continue
                verdict = machine({law: size})
                tried[law] += 1
                seen[law] += verdict.status != "no_gap"
                named[law] += any(law in (c.effect, *c.rivals) for c in verdict.causes)
                if verdict.status == "no_gap":
                    print(f"{kind.__name__} {seed}: {law} of {size:.3g} is not seen", flush=True)
        for law in tried:
            print(f"{kind.__name__}, {law}: seen {seen[law]} of {tried[law]}, named {named[law]}", flush=True)
        print(f"{kind.__name__}: seen {seen.total()} of {tried.total()}, named {named.total()}", flush=True)


if __name__ == "__main__":
    main()
