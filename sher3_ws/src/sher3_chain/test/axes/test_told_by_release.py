"""Two frictions that a force balance may not tell apart: the motion from the release does."""

import numpy as np
import pytest
from sher3_chain.axes.causes.parted_by_release import parted_by_release
from sher3_chain.axes.evidence import gather_axis
from sher3_chain.axes.machine import facts_of
from sher3_chain.axes.simulate import Law, simulate
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import fit
from sher3_effects import pages
from slides import axis_of, columns

SHAPES = {"coulomb_friction": {"displacement": 0.0}, "viscous_friction": {}}


@pytest.fixture(scope="module")
def fallen():
    """A record of an axis of 2 kg under 6 N that is let go and rubs with 1 N."""
    axis = axis_of(
        signals=columns("position"),
        command_law={"kind": "none"},
        encoder_resolution=1e-6,
        gravity={"constant": 6.0},
        mass=2.0,
    )
    start = AxesRun("run", 0.002, {"slide": {"position": np.zeros(800)}})
    position = simulate(start, axis, 2.0, Law(coulomb=1.0, static=1.0))
    return gather_axis([AxesRun("run", 0.002, {"slide": {"position": position}})], axis, False)


def attributed(evidence, cause, rival):
    """One cause, and another that is said to explain as much."""

    def fitted(effect):
        (page,) = (e for e in pages("axis", facts_of(evidence.axis)) if e.id == effect)
        term = Candidates(evidence, [page]).term(page, "slide", SHAPES[effect])
        return fit(evidence.data, [term])

    return Attribution(fitted(cause), ((fitted(rival),),), (1.0,))


def test_a_rival_whose_motion_comes_nearer_takes_the_place(fallen):
    found = parted_by_release(fallen, attributed(fallen, "viscous_friction", "coulomb_friction"))
    assert [t.effect.id for t in found.fit.terms] == ["coulomb_friction"] and found.rivals == ((),)


def test_a_cause_whose_motion_is_right_stays(fallen):
    given = attributed(fallen, "coulomb_friction", "viscous_friction")
    assert parted_by_release(fallen, given) is given
