"""An arm whose logger stamps late, loses samples and repeats some: the speeds it recorded count the periods."""

import numpy as np
import pytest
from lifts import URDF, friction, motion, needed
from sher3_chain.manipulator.draft import draft_arm
from sher3_diagnosis import diagnose
from sher3_machines import import_case, open_case

PERIOD, COULOMB = 2e-3, (2.0, 0.12)


def verdict(tmp_path, seed, jitter):
    """Draft, import and diagnose a log of a lift with dry friction; its stamps jitter by a share of the period."""
    rng = np.random.default_rng(seed)
    q, v, a = motion(16.0, PERIOD, seed=float(seed))
    rows = np.repeat(np.arange(len(q)), rng.choice([0, 1, 2], p=[0.05, 0.9, 0.05], size=len(q)))
    effort = (needed(q, v, a) + friction(v, COULOMB) + 0.02 * rng.normal(size=q.shape))[rows]
    stamps = np.maximum.accumulate(PERIOD * rows + jitter * PERIOD * rng.normal(size=len(rows)))
    columns = [stamps + 1e-7 * np.arange(len(rows)), q[rows], v[rows] + 1e-3 * rng.normal(size=(len(rows), 2)), effort]
    (tmp_path / "lift.urdf").write_text(URDF)
    names = "t,q1,q2,dq1,dq2,tau1,tau2"
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), delimiter=",", header=names, comments="", fmt="%.9g")
    (tmp_path / "a.yaml").write_text(draft_arm(tmp_path / "a.csv", tmp_path / "lift.urdf").text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    return diagnose(*open_case(tmp_path / "case")).verdict


@pytest.mark.parametrize("seed", range(3))
def test_friction_is_told_though_stamps_jitter(tmp_path, seed):
    """Without the counted clock what jitter makes of the acceleration hides both frictions."""
    found = verdict(tmp_path, seed, 0.4)
    assert found.status == "attributed" and any("count whole periods" in note for note in found.notes)
    assert {(c.effect, c.actuator) for c in found.causes} == {
        ("coulomb_friction", "lift"),
        ("coulomb_friction", "swing"),
    }
    for cause, size in zip(sorted(found.causes, key=lambda c: c.actuator), COULOMB, strict=True):
        assert cause.parameters["force"].value == pytest.approx(size, rel=0.15)
