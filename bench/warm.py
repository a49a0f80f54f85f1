"""How long a diagnosis takes once its kernels are compiled: an arm of six joints and 60 s, an axis of 20 s.

    python bench/warm.py --repeats 5

The arm is of MuJoCo, logged at 500 Hz with forces, with dry friction at its elbow and viscous one at its wrist; the
axis is the slide of the tests at 500 Hz, with dry and viscous friction and a weight; drawn axes of 20 s at 1 kHz have
three to six causes at once. Seconds of the processor and of the clock, one thread: least and median; 3 s, and 1 s for
an axis, are sought.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import mujoco
import numpy as np
import sher3.gap as gap
from sher3_diagnosis import diagnose

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import NOISE, asked, served
from drawn_axes import drawn_axis
from slides import driven, machine, run_of

ARM, AXIS = 60.0, 20.0
"""Lengths of the records, s."""
AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")
DRAWN = (10001, 10003, 10005)
"""Seeds of the drawn axes."""


def arm() -> Callable[[], str]:
    """Return the diagnosis of an arm of six joints."""
    bodies = "".join(
        f'<body pos="{0.25 if i else 0} 0 0"><joint name="j{i}" axis="{axis}" damping="{0.5**i:g}" armature="0.02"/>'
        f'<geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.03" mass="{3 * 0.6**i:g}" contype="0" conaffinity="0"/>'
        for i, axis in enumerate(AXES)
    )
    drives = "".join(f'<position joint="j{i}" kp="{600 * 0.5**i:g}" kv="{30 * 0.5**i:g}"/>' for i in range(len(AXES)))
    xml = (
        f'<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody>{bodies}{"</body>" * len(AXES)}'
        f"</worldbody><actuator>{drives}</actuator></mujoco>"
    )
    robot, rng = mujoco.MjModel.from_xml_string(xml), np.random.default_rng(1)
    robot.dof_frictionloss[2] += 1.0
    robot.dof_damping[4] += 0.2
    stamps = 0.002 * np.arange(round(ARM / 0.002))
    ctrl = asked(rng, stamps, len(AXES))
    qpos, force = served(robot, ctrl)
    log = {"time": stamps, "ctrl": ctrl, "qpos": qpos + NOISE * rng.normal(size=qpos.shape), "actuator_force": force}
    return lambda: gap.diagnose(xml, log).headline


def slide() -> Callable[[], str]:
    """Return the diagnosis of a slide with three causes."""
    run = run_of(driven(AXIS, coulomb=8.0, viscous=40.0, offset=5.0))
    return lambda: diagnose(machine(), [run]).verdict.status


def drawn(seed: int) -> Callable[[], str]:
    """Return the diagnosis of the first 20 s of a drawn axis."""
    found = drawn_axis(seed)
    rows = round(AXIS / found.run.period)
    signals = {axis: {name: x[:rows] for name, x in own.items()} for axis, own in found.run.signals.items()}
    run = type(found.run)("run", found.run.period, signals)
    return lambda: diagnose(found.machine, [run]).verdict.status


def spent(work: Callable[[], str], repeats: int) -> tuple[str, list[float], list[float]]:
    """Return the answer, and seconds of processor and clock of each repeat, after one that compiles."""
    said, processor, clock = work(), [], []
    for _ in range(repeats):
        began, before = time.perf_counter(), time.process_time()
        work()
        processor.append(time.process_time() - before)
        clock.append(time.perf_counter() - began)
    return said, processor, clock


def main() -> None:
    """Print a line for each case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    cases = {"arm of six joints, 60 s": arm(), "slide, 20 s": slide()}
    cases |= {f"drawn axis {seed}, 20 s": drawn(seed) for seed in DRAWN}
    for name, work in cases.items():
        said, processor, clock = spent(work, repeats)
        both = ", ".join(
            f"{what} {min(x):.2f} s at least, {median(x):.2f} s median"
            for what, x in (("processor", processor), ("clock", clock))
        )
        print(f"{name}: {both}: {said}", flush=True)


if __name__ == "__main__":
    main()
