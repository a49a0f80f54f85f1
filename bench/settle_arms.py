"""Bench: whether the known mass that the verdict on a slow arm names settles what its odds leave open.

    nice python bench/settle_arms.py --seeds 311000:311020      # drawn arms of MuJoCo, each recorded once

A drawn arm of three joints moves so slowly that its drives give little but weight. The drive of one joint gives another
force than was recorded, or a link has another mass, by 10 to 30 %. Where the best bet has odds between 10 and 90 % and
the verdict foretells what a known mass makes of them, the same arm is recorded with it and judged with both records.
Printed are the odds of what is at work, as expected and as reached.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from settle import OPEN
from settle_axes import Reached, shares
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.foreseen import BESIDE
from sher3_chain.manipulator.kind import KIND
from sher3_diagnosis import Verdict, diagnose

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
from drawn_arms import NAMES, NOISE, drawn_xml

SECONDS, PERIOD, JOINTS = 40.0, 0.004, 3
FORCE_NOISE = 0.002
"""Of a recorded force over its rms."""
AT_WORK = {"gain": {"torque_constant"}, "link": {"gravity_load", "link_mass"}}
"""What is wrong -> effects that are a right answer: the weight of one joint is that of the link behind it."""


class Arm:
    """A drawn arm: `kind` of what is wrong, `joint` at which, and how it moves."""

    def __init__(self, seed: int, folder: Path) -> None:
        rng = np.random.default_rng([seed, 5])
        self.seed, self.kind = seed, tuple(AT_WORK)[seed % 2]
        xml = drawn_xml(rng, servo=False, joints=JOINTS).replace('gravcomp="1"', "")
        self.path = folder / f"{seed}.xml"
        self.path.write_text(xml)
        self.real, row = mujoco.MjSpec.from_string(xml), 1 + int(rng.integers(JOINTS - 1))
        self.joint, size = NAMES[row], float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.3))
        self.gain = np.ones(JOINTS)
        self.gain[row] += size * (self.kind == "gain")
        self.real.bodies[1 + row].geoms[0].mass *= 1.0 + size * (self.kind == "link")

    def put_on(self, mass: float) -> None:
        """Put a mass on the last link, kg."""
        body = self.real.bodies[JOINTS].add_body(pos=BESIDE, mass=mass, inertia=[1e-6] * 3, explicitinertial=True)
        body.ipos, body.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]

    def record(self, name: str) -> AxesRun:
        """Return a record along slow sines: places with their noise, and forces by the drives' nominal gains."""
        model, rng = self.real.compile(), np.random.default_rng([self.seed, 9])
        step, data, rows = model.opt.timestep, mujoco.MjData(model), []
        stiff, gear = 300.0 * 0.5 ** np.arange(JOINTS), model.actuator_gear[:, 0]
        pace, phase = rng.uniform(0.02, 0.1, (JOINTS, 3)), rng.uniform(0.0, 2.0 * np.pi, (JOINTS, 3))
        stamps = np.arange(round(SECONDS / step)) * step
        asked = 0.35 * np.sin(2.0 * np.pi * pace * stamps[:, None, None] + phase).sum(axis=2)
        for place in asked * np.minimum(1.0, stamps / 2.0)[:, None]:
            data.ctrl[:] = (stiff * (place - data.qpos) - 0.05 * stiff * data.qvel) / gear
            mujoco.mj_forward(model, data)
            rows.append([data.qpos.copy(), data.qfrc_actuator.copy()])
            mujoco.mj_step(model, data)
        place, force = np.array(rows)[:: round(PERIOD / step)].swapaxes(0, 1)
        place, force = place + NOISE * rng.standard_normal(place.shape), force / self.gain
        force = force + FORCE_NOISE * force.std(axis=0) * rng.standard_normal(force.shape)
        columns = {n: {"position": place[:, i], "effort": force[:, i]} for i, n in enumerate(NAMES[:JOINTS])}
        return AxesRun(name, PERIOD, columns)

    def judged(self, runs: list[AxesRun], **described: Any) -> Verdict:
        """Return the verdict on some records."""
        effort = runs[0].signals
        read = {"position": {"column": "q", "unit": "rad"}, "effort": {"column": "f", "unit": "N*m"}}
        joints = [
            {"name": n, "motion": "rotary", "signals": read, "encoder_resolution": NOISE}
            | {"effort_resolution": FORCE_NOISE * float(effort[n]["effort"].std())}
            for n in NAMES[:JOINTS]
        ]
        data = {"kind": "manipulator", "name": "arm", "model": str(self.path), "time": {"rate": 1.0 / PERIOD}}
        machine = KIND.machine(ManipulatorDescription.model_validate({**data, "joints": joints, **described}))
        return diagnose(machine, runs).verdict


def settled(seed: int, folder: Path) -> Reached | None:
    """Return the odds of what is at work as expected and as reached, and those of the likeliest answer; None if none.

    A line is printed for each arm.
    """
    arm = Arm(seed, folder)
    first = arm.record("first")
    verdict = arm.judged([first])
    place, asked = next(iter(verdict.places), None), verdict.next_experiment
    wrong = f"{seed}: {arm.kind} of {arm.joint}"
    if place is None or asked is None or asked.expected_odds is None or not OPEN[0] < place.bet.probability < OPEN[1]:
        print(f"{wrong}: no open bet: {said(verdict)}", flush=True)
        return None
    mass = float(re.search(r"([\d.]+) kg", asked.added)[1])
    link = re.search(r"kg on (\S+),", asked.added)[1]
    arm.put_on(mass)
    known = {"second": {"mass": mass, "link": link, "centre": BESIDE}}
    after = arm.judged([first, arm.record("second")], carried=known)
    answers = next((p.answers for p in after.places if p.actuator == place.actuator), ())
    right = sum(a.probability for a in answers if a.causes and {c.effect for c in a.causes} <= AT_WORK[arm.kind])
    likely = max((a.probability for a in answers), default=0.0)
    how = f"{' / '.join(asked.separates)}; {mass:g} kg, {asked.expected_odds:.2f} expected, {right:.2f} reached"
    print(f"{wrong}: {how}: {said(after)}", flush=True)
    return Reached(asked.expected_odds, right, likely)


def said(verdict: Verdict) -> str:
    """Return the causes of a verdict, or its status."""
    return ", ".join(f"{c.effect} on {c.actuator}" for c in verdict.causes) or verdict.status


def main() -> None:
    """Print a line for each arm, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="311000:311020", help="A:B")
    seeds = range(*map(int, parser.parse_args().seeds.split(":")))
    with tempfile.TemporaryDirectory() as folder:
        found = [(tuple(AT_WORK)[seed % 2], settled(seed, Path(folder))) for seed in seeds]
    for kind in AT_WORK:
        shares(f"{kind} wrong", [x for k, x in found if k == kind and x is not None])


if __name__ == "__main__":
    main()
