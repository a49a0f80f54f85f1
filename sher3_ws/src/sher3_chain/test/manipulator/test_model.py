"""The model of a lift with a pendulum against Lagrange's equations by hand."""

import numpy as np
import pytest
from lifts import M1, M2, MJCF, URDF, L, described, motion, needed
from sher3_chain.manipulator.bodies import bodies_of, read_bodies
from sher3_chain.manipulator.kind import KIND
from sher3_chain.manipulator.model import arm_model
from sher3_machines import MachineError


@pytest.fixture(params=[URDF, MJCF], ids=["urdf", "mjcf"])
def model(request, tmp_path):
    return KIND.machine(described(tmp_path / "lift.xml", request.param)).model


def test_forces_are_those_of_lagrange(model):
    q, v, a = motion(2.0)
    np.testing.assert_allclose(model.needed(q, v, a), needed(q, v, a), atol=1e-9)


def test_the_regressor_times_the_model_s_inertias_is_the_force(model):
    q, v, a = motion(1.0)
    np.testing.assert_allclose(model.regressor(q, v, a) @ model.inertial, needed(q, v, a), atol=1e-9)


def test_kinds_links_and_inertias(model):
    assert model.linear == (True, False) and model.links == ("carriage", "pendulum")
    assert np.diag(model.inertia_matrix(np.zeros(2))) == pytest.approx([M1 + M2, 0.01 + M2 * L**2])


def test_a_urdf_may_begin_with_a_blank_line():
    """Macros that are expanded leave one before the declaration, as in published files of an IRB 120."""
    text = '\n<?xml version="1.0"?>' + URDF
    assert list(bodies_of(text, "lift").joints) == ["lift", "swing"]


def test_a_joint_that_was_not_recorded_is_locked(tmp_path):
    path = tmp_path / "lift.urdf"
    path.write_text(URDF)
    alone = arm_model(read_bodies(path), ["swing"], None)
    assert alone.names == ("swing",) and alone.inertia_matrix(np.zeros(1))[0] == pytest.approx([0.01 + M2 * L**2])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (URDF.replace('"swing"', '"sway"'), "no joint 'swing'"),
        ("<robot>", "cannot be read"),
        ("<mujoco><worldbody>", "cannot be read"),
        ('<!DOCTYPE x [<!ENTITY a "b">]>' + URDF, "has a document type"),
        (URDF.replace('type="revolute"', 'type="floating"'), "neither turns nor slides"),
    ],
)
def test_what_cannot_be_used_is_named(tmp_path, text, words):
    with pytest.raises(MachineError, match=words):
        KIND.machine(described(tmp_path / "lift.xml", text))
