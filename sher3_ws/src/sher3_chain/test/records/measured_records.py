"""Measured records as columns, where the folder of data sets is at hand: a chain, a pendulum, an arm."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from nuisances import Record
from sher3_machines import described
from sher3_machines.intake.tables import read_tables

Clean = tuple[dict[str, Any], Record]
SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).parents[6] / "shared"))
REAL = SHARED / "real"


def _of_set(name: str, file: str, roles: Mapping[str, str]) -> Clean:
    text = described(Path(name)).read_text(encoding="utf-8")
    columns = {k: np.asarray(x, dtype=float) for k, x in read_tables(REAL / file).items() if x.ndim == 1}
    n = len(columns[roles["position"]])
    return yaml.safe_load(text), Record({k: x for k, x in columns.items() if len(x) == n}, roles, {}, {})


def emps() -> Clean:
    """The slide of EMPS: a force, a position law, 25 s at 1 kHz."""
    roles = {"time": "t", "position": "qm", "reference": "qg", "command": "vir"}
    return _of_set("emps", "emps/DATA_EMPS.mat", roles)


def rhoban() -> Clean:
    """A pendulum on a servo that is let go."""
    return _of_set("rhoban_mx_drop", "rhoban_mx_drop/friction_1.json", {"time": "timestamps", "position": "positions"})


def double_pendulum() -> Clean:
    """Run A7 of the double pendulum, 75 s at 300 Hz; nuisances on its first joint."""
    folder = REAL / "dfki_double_pendulum"
    text = yaml.safe_load((folder / "dpA.yaml").read_text(encoding="utf-8"))
    text["model"] = str(folder / "dpA.urdf")
    roles = {"time": "time", "position": "pos1", "effort": "tau1"}
    return text, Record(read_tables(folder / "A7.csv"), roles, {}, {})


def kuka() -> Clean:
    """Axis 1 of run B of a KUKA KR300, two encoders, 10 s at 250 Hz; the columns of one axis by their names."""
    from scipy.io import loadmat

    found = loadmat(REAL / "kuka_kr300/runB.mat", squeeze_me=True, struct_as_record=False)["rec"]
    columns = {"t": np.asarray(found.time_cont, dtype=float)}
    units = {"position": "act_pos_mot_deg", "reference": "ref_pos_deg", "load": "act_pos_se_deg"}
    for role, name in {**units, "effort": "act_torque_abs_nm"}.items():
        columns[role] = np.asarray(getattr(found, name), dtype=float)[0]
    signals = {role: {"column": role, "unit": "deg"} for role in units}
    signals["effort"] = {"column": "effort", "unit": "N*m", "factor": 256.857}
    axis = {"name": "A1", "motion": "rotary", "signals": signals, "command_law": {"kind": "force"}, "mass": "unknown"}
    axis |= {"encoder_resolution": 1e-6, "lead": 0.024462}
    described = {"kind": "axes", "name": "KR300", "time": {"column": "t", "unit": "s"}, "axes": [axis]}
    return described, Record(columns, {"time": "t", **{x: x for x in signals}}, {}, {})


MEASURED: Mapping[str, Callable[[], Clean]] = {f.__name__: f for f in (emps, rhoban, double_pendulum, kuka)}
"""Every measured record by its name."""
