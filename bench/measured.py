"""Measured machines (`SHER3_SHARED/real`) for benches: the quick sets of `sher3_machines/test/test_real.py`.

No weight is ever set on them. Each names what is known of the machine from outside: causes that must be among those
named, by effect and place, and the status.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from sher3_diagnosis.machine import Machine
from sher3_machines import described, import_case, open_case

REAL = Path(os.environ.get("SHER3_SHARED", Path(__file__).parents[2] / "shared")) / "real"


class Measured(NamedTuple):
    """A measured set.

    Attributes:
        name: of it and of its description.
        files: below `REAL`; a pattern.
        known: effects joined by `|` and place of causes that are at work.
    """

    name: str
    files: str
    known: Sequence[tuple[str, str]]


def on(effect: str, *places: str) -> list[tuple[str, str]]:
    """Return an effect at several places."""
    return [(effect, p) for p in places]


LATE = "drive_lag|command_delay|sensor_delay"
DRY = "coulomb_friction|stribeck_friction|presliding_friction|gear_loss"
SETS = (
    Measured(
        "emps", "emps/DATA_EMPS.mat",
        [(e, "slider") for e in ("coulomb_friction", "viscous_friction", "gravity_load")],
    ),
    Measured("rhoban_mx_drop", "rhoban_mx_drop/friction_1.json", on("coulomb_friction", "servo")),
    Measured(
        "sage_so101", "sage_so101/output/real/so101/custom/*",
        [*on("gravity_load", "Pitch", "Elbow"), *on(LATE, "Rotation", "Wrist_Roll", "Jaw"),
         *on("coulomb_friction", "Rotation", "Pitch", "Elbow")],
    ),
    Measured(
        "dfki_simple_pendulum",
        "dfki_simple_pendulum/results/control_method_pd/1nm_torque_limited_swingup_failure",
        on("force_saturation", "joint"),
    ),
    Measured("tiago_dynamics", "tiago_dynamics", on(DRY, "torso_lift_joint", *(f"arm_{i}_joint" for i in range(1, 5)))),
    Measured("franka_fr3_calib", "franka_fr3_calib/calib_data_converted.npz", [("encoder_offset", "")]),
    Measured("dfki_double_pendulum", "dfki_double_pendulum/A7.csv", on("gear_loss", "joint1", "joint2")),
    Measured("davinci_tool", "davinci_tool/0[0-3].TXT", on("lead_error", "spindle")),
)  # fmt: skip


def opened(measured: Measured) -> tuple[Machine, Sequence[Any]]:
    """Return the machine and the runs of a set."""
    folder = Path(tempfile.mkdtemp()) / measured.name
    import_case(sorted(REAL.glob(measured.files)), described(Path(measured.name)), folder)
    return open_case(folder)


def kept(measured: Measured, named: Sequence[tuple[str, str]]) -> Iterator[bool]:
    """Yield for each known cause whether it is among those named, by effect and place."""
    for effects, place in measured.known:
        yield any(e in effects.split("|") and place in (a, "") for e, a in named)
