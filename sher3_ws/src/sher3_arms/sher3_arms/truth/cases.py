"""Sealed cases: a seed gives the arm, the fault and the motion; the label stays here."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sher3_arms.errors import NeverStable, Unstable
from sher3_arms.files import write_case
from sher3_arms.truth.faults import ORDER, Fault, deal
from sher3_arms.truth.robots import urdf_of
from sher3_arms.truth.world import COUNT, inertias, inverse, load, motion, record, shows

DRAWS = 50
"""Faults drawn for a case at most, until the arm follows its motion in spite of one that shows."""
SIZING = 20.0
"""Seconds of a motion from which the size of a fault is taken."""


@dataclass(frozen=True)
class Label:
    """The truth of one case.

    Attributes:
        seed: of the case.
        robot: name of the arm.
        fault: what is wrong.
        joint: name of its joint; empty for a healthy arm.
        link: the link behind that joint.
        second: the joint of the other fault of a compound case.
        drawn: faults drawn until the arm followed its motion and the fault showed.
    """

    seed: int
    robot: str
    fault: Fault
    joint: str = ""
    link: str = ""
    second: str = ""
    drawn: int = 1


def seal(seed: int, robots: Sequence[str], folder: Path, seconds: float, kinds: Sequence[str] = ORDER) -> Label:
    """Write the case of a seed into a new folder and return its label; arms and kinds of fault are taken in turn.

    A fault under which the arm does not follow its motion is drawn again: nobody keeps such a record. So is a gap that
    is never crossed: the record is that of an arm with soft stops.

    Raises:
        ArmsError: no such arm, or MuJoCo or the wheel with the arms is missing.
        NeverStable: no draw is stable and shows.
    """
    robot = robots[seed % len(robots)]
    urdf = urdf_of(robot)
    nominal, rng = load(urdf), np.random.default_rng([seed, 8128])
    _, q, v, a = motion(nominal, SIZING, np.random.default_rng([seed, 496]))
    torque = np.sqrt(np.mean(inverse(nominal, q, v, a) ** 2, axis=0))
    speed = np.sqrt(np.mean(v**2, axis=0))
    kind, inertia = kinds[seed % len(kinds)], inertias(nominal, q[0])
    drawn, found = 0, None
    while found is None:
        if drawn == DRAWS:
            text = f"seed {seed}: {robot} is unstable with every {kind}, or none shows"
            raise NeverStable(text, value=f"{DRAWS} draws", remedy="choose another seed or arm")
        drawn, fault = drawn + 1, deal(rng, kind, torque, speed, inertia)
        with suppress(Unstable):
            made = record(urdf, fault, seconds, rng)
            found = made if shows(fault, made) else None
    arrays = {"time": found.time, "position": found.position, "effort": found.effort, "link": found.link}
    write_case(folder, urdf, found.names, arrays, COUNT, found.noise)
    if fault.joint < 0:
        return Label(seed, robot, fault, drawn=drawn)
    link = nominal.body(int(nominal.jnt_bodyid[fault.joint])).name
    second = "" if fault.second is None else found.names[fault.second.joint]
    return Label(seed, robot, fault, found.names[fault.joint], link, second, drawn)
