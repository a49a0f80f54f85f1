"""A window diagnosed, in a process of its own that yields to the robot's."""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from sher3_common.errors import Sher3Error

from sher3_gap_cli.watch.window import Array

if TYPE_CHECKING:
    from sher3_chain.manipulator.bodies import Bodies
    from sher3_diagnosis.verdict import Cause

NICE = 10
"""By how much the process of the diagnosis yields to others."""
OK, WARN, STALE = 0, 1, 3
"""Levels of a diagnostic status."""


class Status(NamedTuple):
    """One status: name, level, sentence, and values by key."""

    name: str
    level: int
    message: str
    values: Mapping[str, str] = {}


def judged(model: str, joints: tuple[str, ...], arrays: tuple[Array | None, ...]) -> list[Status]:
    """Return the statuses of a window (time, command, position, effort); a window that cannot be judged says why."""
    from sher3_chain.manipulator.causes.links import OTHER_ROBOT
    from sher3_diagnosis.report.summary import cause_text
    from sher3_public.models import source_of
    from sher3_public.one_call import diagnose

    time, command, position, effort = arrays
    try:
        control = None if command is None else actuator_commands(source_of(model).bodies, joints, command)
        found = diagnose(model, time, control, position, effort, joints=joints)
    except Sher3Error as error:
        return [Status("gap", STALE, str(error))]
    level = OK if found.status == "no_gap" else WARN
    another = [Status("gap/model", WARN, note) for note in found.notes if note.startswith(OTHER_ROBOT)]
    causes = [Status(f"gap/{c.actuator}", WARN, cause_text(c), sizes(c)) for c in found.causes]
    places = {f"{w.stage}/{w.actuator}": f"{w.gap:.4g} over {w.floor:.4g} {w.unit}" for w in found.places}
    return [Status("gap", level, found.headline, {"status": found.status, **places}), *another, *causes]


def sizes(cause: Cause) -> dict[str, str]:
    """Return the parameters of a cause as text."""
    return {name: f"{p.value:.6g} {p.unit}" for name, p in cause.parameters.items()}


def actuator_commands(bodies: Bodies, joints: Sequence[str], command: Array) -> Array | None:
    """Return a command of joints (n, k) in the order of the model's actuators (n, nu); None where it has none."""
    if bodies.mujoco is None:
        return None
    control = np.zeros((len(command), bodies.mujoco.nu))
    for name, column in zip(joints, command.T, strict=True):
        driven = bodies.drives.get(name)
        if driven is not None and driven.drive is not None:
            control[:, driven.drive.number] = column
    return control


def yielding() -> None:
    """Lower the priority of this process, keep it to one thread, and leave Ctrl-C to the process of the node."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICE)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[name] = "1"
