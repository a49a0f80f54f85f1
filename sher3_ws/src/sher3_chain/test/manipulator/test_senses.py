"""Joints recorded in the other sense than the model has: they are turned and said, and the causes stay."""

import numpy as np
import pytest
from lifts import friction, machine, motion, needed, run_of
from sher3_diagnosis import diagnose

COULOMB = (8.0, 0.5)


def verdict(path, seed, senses, **changes):
    q, v, a = motion(seed=seed)
    signs = np.array(senses)
    return diagnose(
        machine(path, **changes), [run_of(signs * q, signs * (needed(q, v, a) + friction(v, COULOMB)))]
    ).verdict


@pytest.fixture
def path(tmp_path):
    return tmp_path / "lift.urdf"


@pytest.mark.parametrize("seed", [0.0, 0.7])
@pytest.mark.parametrize(("senses", "told"), [((1, 1), ""), ((-1, 1), "lift"), ((-1, -1), "lift")])
def test_a_joint_in_the_other_sense_is_turned_and_said(path, seed, senses, told):
    """A pendulum mirrors: its own sense is told by nothing, and turning it changes nothing."""
    found = verdict(path, seed, senses)
    assert found.status == "attributed"
    sizes = {(c.effect, c.actuator): c.parameters["force"].value for c in found.causes}
    assert sizes == pytest.approx({("coulomb_friction", "lift"): 8.0, ("coulomb_friction", "swing"): 0.5}, rel=0.05)
    assert [n.split(":")[0] for n in found.notes if "other sense" in n] == ([told] if told else [])


def test_the_sense_is_told_without_a_gain(path):
    unknown = {j: {"gain": "unknown"} for j in ("lift", "swing")}
    assert any(n.startswith("lift: recorded in the other") for n in verdict(path, 0.0, (-1, 1), joint=unknown).notes)
