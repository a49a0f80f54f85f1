"""Every effect of the library: complete, consistent with the simulator's, and able to evaluate its signature."""

import numpy as np
import pytest
from sher3_gap.channels import STAGES
from sher3_gap.evidence import gather
from sher3_gap.fitting import make_term
from sher3_gap.library import LIBRARY
from sher3_sim.effects import EFFECTS
from simulated import ROBOT, runs_of, signals


@pytest.fixture(scope="module")
def evidence():
    return gather(signals(runs_of(("reversals", "loads"), repeats=1)), ROBOT)


def test_library_and_simulator_know_the_same_effects():
    assert LIBRARY.keys() == EFFECTS.keys()


@pytest.mark.parametrize("effect", LIBRARY.values(), ids=LIBRARY)
def test_an_effect_says_what_it_is(effect):
    assert effect.stage in STAGES
    assert (effect.family, effect.stage) == (EFFECTS[effect.id].family, EFFECTS[effect.id].stage)
    assert effect.explanation.endswith(".")
    assert effect.siblings and effect.siblings.keys() <= LIBRARY.keys()
    assert set(effect.extends) <= LIBRARY.keys()


@pytest.mark.parametrize("effect", LIBRARY.values(), ids=LIBRARY)
def test_signatures_are_finite_on_their_channels(effect, evidence):
    site = effect.sites()[0]
    shapes = effect.shapes(evidence.views, site) if effect.channels(site) else []
    for shape in shapes[:2]:
        term = make_term(evidence.data, effect, site, shape)
        for part in (*term.columns, *term.fixed):
            for channel, values in part.items():
                assert np.isfinite(values).all(), (effect.id, channel)
        coefficients = np.ones(term.width) * 0.1
        for name, value in effect.parameters(shape, coefficients).items():
            assert np.isfinite(value)
            assert effect.unit(name, site)
