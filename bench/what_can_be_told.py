"""How often a fault of a drawn arm of MuJoCo is told; `bench/drawn_machines.py` says it of axes and servos.

    nice python bench/what_can_be_told.py

A fault counts as told where effect and joint (or its link) stand among the causes or their rivals; "alone" is without a
rival. The arms have two to four joints and position servos, and are known by their healthy model, their controls,
positions with noise of 10 urad and forces.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import mujoco
import numpy as np
import sher3.gap as gap
from beside_sysid import Hidden, faulty, moved
from drawn_arms import NAMES, drawn_xml

FIRST = 5000
"""First seed: none of the tests' or of other benches."""
RIGHT = {
    "coulomb": ("coulomb_friction",),
    "viscous": ("viscous_friction",),
    "stribeck": ("stribeck_friction", "coulomb_friction"),
    "rotor": ("rotor_inertia",),
    "payload": ("payload_mass", "link_mass"),
    "gain": ("controller_gain",),
    "late command": ("command_delay",),
    "spring": ("spring_torque",),
    "cogging": ("cogging",),
    "load friction": ("gear_loss",),
}
"""Fault of an arm -> effects that are right."""


def arm(seed: int, kind: str) -> tuple[bool, bool]:
    """Return whether the fault of a drawn arm is told, and whether alone."""
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng).replace('gravcomp="1"', 'gravcomp="0"')  # it would take the weight of a payload, too
    joints = mujoco.MjModel.from_xml_string(xml).nu
    fault = Hidden(kind, int(rng.integers(joints)), float(rng.uniform(0.4, 1.0)))
    log = moved(faulty(xml, fault), seed, fault)
    gears = mujoco.MjModel.from_xml_string(xml).actuator_gear[:, 0]
    found = gap.diagnose(xml, log.time, log.ctrl, log.qpos, log.force * gears)
    places = (NAMES[fault.joint], f"body{fault.joint + 1}" if kind != "payload" else f"body{joints}")
    here = [c for c in found.causes if c.actuator in places]
    told = [c for c in here if {c.effect, *c.rivals} & set(RIGHT[kind])]
    return bool(told), any(not c.rivals for c in told)


def arms(count: int, kinds: Sequence[str]) -> None:
    """Print how many faults of drawn arms are told, by kind."""
    for kind in kinds:
        found = [arm(FIRST + i, kind) for i in range(count)]
        told, alone = (sum(x) for x in zip(*found, strict=True))
        print(f"arm: {kind}: {told} of {count}, {alone} alone", flush=True)


def main() -> None:
    """Print a line for each fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", type=int, default=4, help="drawn for each fault")
    parser.add_argument("--kinds", nargs="*", default=list(RIGHT), choices=list(RIGHT))
    given = parser.parse_args()
    arms(given.arms, given.kinds)


if __name__ == "__main__":
    main()
