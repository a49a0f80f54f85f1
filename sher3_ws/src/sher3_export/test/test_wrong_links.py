"""Links whose inertial parameters are wrong: written as bodies that can exist and move as the verdict says."""

import numpy as np
import pytest
from linked_models import MJCF, MODELS, URDF, tree_of
from sher3_chain.manipulator.rigid.dynamics import forces
from sher3_export import export
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

HEAVIER = {"mass": 0.5, "mx": 0.1, "mz": 0.03, "iyy": 0.04}
OF_HEAVIER = [10, 11, 13, 16]


def written(to, *causes, text=None):
    given, root = MODELS[to]
    return export(verdict(*causes), to, parse_xml(text or given, root))


def needed(tree, change=0.0):
    rng = np.random.default_rng(1)
    q, v, a = (rng.normal(size=(300, 2)) * size for size in (1.0, 2.0, 8.0))
    return forces(tree, tree.inertial + change, q, v, a)


@pytest.mark.parametrize("to", MODELS)
def test_a_wrong_link_moves_as_the_verdict_says_and_twice_as_far_when_said_twice(to):
    """The mesh of a body that states its inertia is not there, and not needed."""
    wrong = cause("link_inertia", "fore", change=0.104, **HEAVIER)
    done = written(to, wrong)
    assert len(done.applied) == 4 and not done.not_expressed and "next to" in done.text
    again = written(to, wrong, text=done.text)
    for times, text in ((1.0, done.text), (2.0, again.text)):
        change = np.zeros(20)
        change[OF_HEAVIER] = times * np.array(list(HEAVIER.values()))
        wanted = needed(tree_of(MODELS[to][0]), change)
        assert np.abs(needed(tree_of(text)) - wanted).max() < 0.01 * np.abs(wanted).max()


def test_sums_over_links_become_bodies_that_can_exist():
    """Three kilograms at the elbow belong to either link: taken off the one and put on the other nothing moves."""
    mass, at = 3.0, 0.4
    off = cause("link_inertia", "fore", change=0.0, mass=-mass)
    on = cause("link_inertia", "upper", change=mass * at, mass=mass, mx=mass * at, iyy=mass * at**2, izz=mass * at**2)
    found, nominal = tree_of(written("urdf", off, on).text), tree_of(URDF)
    assert all(link.inertia[0] > 0.0 for link in found.links)
    assert np.abs(needed(found) - needed(nominal)).max() < 0.01 * np.abs(needed(nominal)).max()


def test_a_compiler_that_takes_inertias_from_geoms_would_not_see_them():
    text = MJCF.replace("<asset>", '<compiler inertiafromgeom="true"/><asset>')
    done = written("mjcf", cause("link_inertia", "fore", change=0.1, mx=0.1), text=text)
    assert "inertiafromgeom" in done.not_expressed[0].reason and not done.applied
