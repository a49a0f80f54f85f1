"""Sealed in MuJoCo, answered blind: springs and cables over position, and efforts whose unit differs by run."""

from pathlib import Path

import numpy as np
import pytest
from sher3_arms import run_arms
from sher3_arms.files import DESCRIPTION, write_case
from sher3_arms.truth.faults import Fault
from sher3_arms.truth.robots import OWN, urdf_of
from sher3_arms.truth.world import COUNT, record
from sher3_common import dump_yaml, read_yaml
from sher3_diagnosis import diagnose
from sher3_machines import import_case, open_case

SECONDS = 20.0


@pytest.mark.slow
def test_springs_and_cables_are_named_on_their_joint(tmp_path):
    found = run_arms(range(500, 506), [OWN], tmp_path / "run", SECONDS, kinds=["spring", "cable"])
    assert all(case.top and case.placed for case in found), [(c.kind, c.effect, c.place) for c in found]


@pytest.mark.slow
def test_efforts_in_another_unit_in_every_run_keep_their_common_friction(tmp_path):
    """0.5 and 2 units a newton metre on the second joint, 1.5 N m of friction in both runs."""
    names, folder, files = (), tmp_path / "sealed", []
    for k, units in enumerate((0.5, 2.0)):
        found = record(urdf_of(OWN), Fault("coulomb", 1, 1.5), SECONDS, np.random.default_rng(k))
        names, effort = found.names, found.effort * np.array([1.0, units, 1.0])
        files.append(tmp_path / f"run_{k}.npz")
        arrays = {"time": found.time, "position": found.position, "effort": effort, "link": found.link}
        np.savez(files[-1], **arrays)
    write_case(folder, urdf_of(OWN), names, arrays, COUNT, found.noise)
    data = read_yaml(folder / DESCRIPTION)
    data["joints"][1]["gain"] = "per_run"
    (folder / DESCRIPTION).write_text(dump_yaml(data))
    import_case(files, Path(folder / DESCRIPTION), tmp_path / "case")
    verdict = diagnose(*open_case(tmp_path / "case")).verdict
    cause = verdict.causes[0]
    assert (cause.effect, cause.actuator) == ("coulomb_friction", names[1])
    assert cause.parameters["force"].value == pytest.approx(1.5, rel=0.1)  # in MuJoCo friction is soft: it creeps
    assert any("run by run" in note for note in verdict.notes)
