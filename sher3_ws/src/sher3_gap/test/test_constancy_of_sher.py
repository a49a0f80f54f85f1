"""A true effect has one size in every excitation; one that stands in for another does not."""

import numpy as np
from sher3_diagnosis.attribute.constancy import constancy_of
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_effects import library, plants
from sher3_gap.evidence import gather
from simulated import ROBOT, runs_of, signals


def found(effect, **truth):
    runs = runs_of(("reversals", "sweep", "sweep_0.4"), [plants()["coulomb_friction"]("delta_1", force=1.0)], repeats=1)
    evidence = gather(signals(runs), ROBOT)
    term = make_term(evidence.data, library()[effect], "delta_1", truth)
    return constancy_of(evidence, fit(evidence.data, [term]), 0)


def test_the_true_effect_is_constant():
    result = found("coulomb_friction", displacement=5e-6)
    assert result.constant
    assert result.spread < 0.01


def test_an_absorber_is_not():
    result = found("viscous_friction")
    assert not result.constant
    assert result.spread > 0.05
    assert np.isfinite(result.explained)
